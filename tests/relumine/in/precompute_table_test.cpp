// Options of a precompute as text.
#include "relumine/in/precompute_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace relumine {
namespace {

void expect_refusal(const std::string& text, const std::string& part) {
    std::vector<SurfaceMaterial> materials;
    try {
        material_row(materials).set(text);
        ADD_FAILURE() << "accepted: " << text;
    } catch (const OptionError& error) {
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

prt::SurfaceOverride override_of(const std::vector<SurfaceMaterial>& materials,
                                 const mesh::TriangleMesh& mesh) {
    return surface_override(materials, mesh);
}

TEST(MaterialText, EachModel) {
    EXPECT_EQ(
        MaterialText::read("ggx:roughness=0.3,albedo=0.5,0.25,0.125,f0=0.04").applied_to(Plain),
        (prt::Surface{.albedo = {0.5f, 0.25f, 0.125f},
                      .specular = glm::vec3(0.04f),
                      .highlight = prt::Highlight::GgxWhole,
                      .roughness_or_exponent = 0.3f}));
    EXPECT_EQ(MaterialText::read("ggx-published:roughness=0.3").applied_to(Gold).highlight,
              prt::Highlight::Ggx);
    EXPECT_EQ(MaterialText::read("blinn:exponent=50,kd=0.5,0.25,0.5,ks=0.5").applied_to(Gold),
              (prt::Surface{.albedo = {0.5f, 0.25f, 0.5f},
                            .specular = glm::vec3(0.5f),
                            .highlight = prt::Highlight::BlinnPhong,
                            .roughness_or_exponent = 50.0f}));
    EXPECT_EQ(MaterialText::read("lambert:albedo=0.5").applied_to(Gold),
              (prt::Surface{.albedo = glm::vec3(0.5f)}));
}

TEST(MaterialText, WhatIsLeftOutIsTheFiles) {
    EXPECT_EQ(MaterialText::read("lambert").applied_to(Plain), Plain);
    const prt::Surface gold = MaterialText::read("ggx:roughness=0.1").applied_to(Gold);
    EXPECT_EQ(gold.specular, Gold.specular);
    EXPECT_EQ(gold.roughness_or_exponent, 0.1f);
    const prt::Surface plastic = MaterialText::read("ggx:roughness=0.1").applied_to(Plain);
    EXPECT_EQ(plastic.albedo, Plain.albedo);
    EXPECT_EQ(plastic.specular, glm::vec3(0.04f));
    EXPECT_EQ(MaterialText::read("blinn:ks=0.5,exponent=0").applied_to(Plain).albedo, Plain.albedo);
}

TEST(MaterialText, Groups) {
    mesh::TriangleMesh mesh;
    mesh.groups = {"body", "a=b:c"};
    mesh.triangles = {{0, 1, 2}, {0, 1, 2}};
    mesh.triangle_groups = {0, 1};
    EXPECT_EQ(MaterialText::read("a=b:c=lambert:albedo=0").group, "a=b:c");
    EXPECT_EQ(MaterialText::read("ggx=lambert").group, "ggx");
    const prt::SurfaceOverride one =
        override_of({MaterialText::read("body=lambert:albedo=0.5")}, mesh);
    EXPECT_EQ(one(mesh, 0, Gold).albedo, glm::vec3(0.5f));
    EXPECT_EQ(one(mesh, 1, Gold), Gold);
    const prt::SurfaceOverride both =
        override_of({MaterialText::read("lambert:albedo=1"),
                     MaterialText::read("a=b:c=ggx:roughness=0.5,albedo=0.5")},
                    mesh);
    EXPECT_EQ(both(mesh, 0, Gold).albedo, glm::vec3(1.0f));
    EXPECT_EQ(both(mesh, 1, Gold).roughness_or_exponent, 0.5f);
    const auto unknown = [&mesh] {
        static_cast<void>(override_of({MaterialText::read("lid=lambert")}, mesh));
    };
    EXPECT_THROW(unknown(), std::invalid_argument);
    mesh.groups.clear();
    mesh.triangle_groups.clear();
    EXPECT_THROW(unknown(), std::invalid_argument);
    EXPECT_EQ(override_of({MaterialText::read("lambert:albedo=1")}, mesh)(mesh, 0, Gold).albedo,
              glm::vec3(1.0f));
    EXPECT_EQ(override_of({}, mesh)(mesh, 0, Gold), Gold);
}

TEST(MaterialText, RefusesWrongText) {
    for (const char* text : {"phong:ks=1", "body=", "roughness=0.3", "ggxx", ":", "="})
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

TEST(MaterialText, IsWrittenAsItIsRead) {
    for (const char* text : {"ggx:albedo=0.5,0.25,0.125,f0=0.04,roughness=0.3", "lambert",
                             "a=b=blinn:kd=0.25,ks=0.5,exponent=50"})
        EXPECT_EQ(MaterialText::show(MaterialText::read(text)), text);
}

TEST(ReceiversText, IsWrittenAsItIsRead) {
    for (const char* text : {"vertices", "pixels:640x480:2", "pixels:4x3", "texels:1x16384"})
        EXPECT_EQ(ReceiversText::show(ReceiversText::read(text)), text);
    for (const char* text : {"", "vertices:1x1", "pixels", "pixels:", "pixels:0x1", "pixels:4x3:0",
                             "pixels:4x3:65", "pixels:4x3:2:2", "texels:4x3:2", "texels:16385x1"})
        EXPECT_THROW(static_cast<void>(ReceiversText::read(text)), std::invalid_argument) << text;
}

TEST(ViewText, IsWrittenAsItIsRead) {
    for (const char* text : {"auto", "0,1,5,0,0,0.5,40"})
        EXPECT_EQ(ViewText::show(ViewText::read(text)), text);
    EXPECT_EQ(ViewText::show(ViewText::read("0,1,5,0,0,0")), "0,1,5,0,0,0,35");
    for (const char* text : {"", "front", "1,2,3", "0,1,5,0,0,0,0", "0,0,0,0,0,0", "1e19,0,0,0,0,0",
                             "0,1,5,0,0,0,40,1"})
        EXPECT_THROW(static_cast<void>(ViewText::read(text)), std::invalid_argument) << text;
}

TEST(MemoryText, HasAUnit) {
    EXPECT_EQ(MemoryText::read("500M"), std::uint64_t{500} << 20);
    EXPECT_EQ(MemoryText::read("1.5GiB"), std::uint64_t{3} << 29);
    EXPECT_EQ(MemoryText::read("2kB"), 2048u);
    EXPECT_EQ(MemoryText::read(MemoryText::show(100000)), 100000u);
    for (const char* text : {"", "50", "M", "-1M", "1X", "1MBs", "0B", "1BB", "1e30T", "nanM"})
        EXPECT_THROW(static_cast<void>(MemoryText::read(text)), std::invalid_argument) << text;
}

} // namespace
} // namespace relumine
