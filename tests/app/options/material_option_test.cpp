// Materials on the command line.
#include "app/options/material_option.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/command_line/command_line.h"

namespace relumine::app {
namespace {

void expect_refusal(const std::string& text, const std::string& part) {
    try {
        static_cast<void>(parse_material(text));
        ADD_FAILURE() << "accepted: " << text;
    } catch (const UsageError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("--material"));
        EXPECT_THAT(error.what(), testing::HasSubstr("expected"));
        EXPECT_THAT(error.what(), testing::HasSubstr(part)) << text;
    }
}

const prt::Surface Plain = {.albedo = glm::vec3(0.25f)};
const prt::Surface Gold = {.albedo = glm::vec3(0.0f),
                           .specular = {1.0f, 0.75f, 0.25f},
                           .highlight = prt::Highlight::Ggx,
                           .roughness_or_exponent = 0.9f};

TEST(MaterialOption, EachModel) {
    EXPECT_EQ(parse_material("ggx:roughness=0.3,albedo=0.5,0.25,0.125,f0=0.04").applied_to(Plain),
              (prt::Surface{.albedo = {0.5f, 0.25f, 0.125f},
                            .specular = glm::vec3(0.04f),
                            .highlight = prt::Highlight::Ggx,
                            .roughness_or_exponent = 0.3f}));
    EXPECT_EQ(parse_material("blinn:exponent=50,kd=0.5,0.25,0.5,ks=0.5").applied_to(Gold),
              (prt::Surface{.albedo = {0.5f, 0.25f, 0.5f},
                            .specular = glm::vec3(0.5f),
                            .highlight = prt::Highlight::BlinnPhong,
                            .roughness_or_exponent = 50.0f}));
    EXPECT_EQ(parse_material("lambert:albedo=0.5").applied_to(Gold),
              (prt::Surface{.albedo = glm::vec3(0.5f)}));
}

TEST(MaterialOption, WhatIsLeftOutIsTheFiles) {
    EXPECT_EQ(parse_material("lambert").applied_to(Plain), Plain);
    const prt::Surface gold = parse_material("ggx:roughness=0.1").applied_to(Gold);
    EXPECT_EQ(gold.specular, Gold.specular);
    EXPECT_EQ(gold.roughness_or_exponent, 0.1f);
    const prt::Surface plastic = parse_material("ggx:roughness=0.1").applied_to(Plain);
    EXPECT_EQ(plastic.albedo, Plain.albedo);
    EXPECT_EQ(plastic.specular, glm::vec3(0.04f));
    EXPECT_EQ(parse_material("blinn:ks=0.5,exponent=0").applied_to(Plain).albedo, Plain.albedo);
}

TEST(MaterialOption, Groups) {
    mesh::TriangleMesh mesh;
    mesh.groups = {"body", "a=b:c"};
    mesh.triangles = {{0, 1, 2}, {0, 1, 2}};
    mesh.triangle_groups = {0, 1};
    EXPECT_EQ(parse_material("a=b:c=lambert:albedo=0").group, "a=b:c");
    EXPECT_EQ(parse_material("ggx=lambert").group, "ggx");
    const prt::SurfaceOverride one =
        surface_override({parse_material("body=lambert:albedo=0.5")}, mesh);
    EXPECT_EQ(one(mesh, 0, Gold).albedo, glm::vec3(0.5f));
    EXPECT_EQ(one(mesh, 1, Gold), Gold);
    const prt::SurfaceOverride both = surface_override(
        {parse_material("lambert:albedo=1"), parse_material("a=b:c=ggx:roughness=0.5,albedo=0.5")},
        mesh);
    EXPECT_EQ(both(mesh, 0, Gold).albedo, glm::vec3(1.0f));
    EXPECT_EQ(both(mesh, 1, Gold).roughness_or_exponent, 0.5f);
    const auto unknown = [&mesh] {
        static_cast<void>(surface_override({parse_material("lid=lambert")}, mesh));
    };
    EXPECT_THROW(unknown(), UsageError);
    mesh.groups.clear();
    mesh.triangle_groups.clear();
    EXPECT_THROW(unknown(), UsageError);
    EXPECT_EQ(surface_override({parse_material("lambert:albedo=1")}, mesh)(mesh, 0, Gold).albedo,
              glm::vec3(1.0f));
    EXPECT_EQ(surface_override({}, mesh)(mesh, 0, Gold), Gold);
}

TEST(MaterialOption, RefusesWrongText) {
    for (const char* text : {"", "phong:ks=1", "body=", "roughness=0.3", "ggxx", ":", "="})
        expect_refusal(text, "[GROUP=]ggx:...");
    expect_refusal("=lambert", "a group's name");
    expect_refusal("ggx", "one number of roughness");
    expect_refusal("ggx:", "one number of roughness");
    expect_refusal("ggx:albedo=0.5", "one number of roughness");
    expect_refusal("ggx:roughness=0.1,0.2", "one number of roughness");
    expect_refusal("ggx:roughness=", "numbers of 0 to 1 as roughness, got ''");
    expect_refusal("ggx:roughness=1.5", "got '1.5'");
    expect_refusal("ggx:roughness=nan", "got 'nan'");
    expect_refusal("ggx:roughness=-0.1", "got '-0.1'");
    expect_refusal("ggx:roughness=0.1x", "got '0.1x'");
    expect_refusal("ggx:roughness=0.1,", "NAME=VALUE");
    expect_refusal("ggx:0.1", "NAME=VALUE");
    expect_refusal("ggx:roughness=0.1,albedo=0.5,0.5", "1 or 3 numbers of albedo, got '0.5,0.5'");
    expect_refusal("ggx:roughness=0.1,roughness=0.2", "roughness once");
    expect_refusal("ggx:roughness=0.1,kd=1", "albedo, f0, roughness of ggx, got 'kd'");
    expect_refusal("lambert:roughness=0.1", "albedo of lambert");
    expect_refusal("blinn:exponent=50", "ks of blinn");
    expect_refusal("blinn:exponent=-1,ks=0.5", "numbers of 0 to");
    expect_refusal("blinn:exponent=50,kd=0.75,ks=0,0,0.5", "kd + ks of 1 or less");
}

} // namespace
} // namespace relumine::app
