#include "files/json.h"

#include <limits>
#include <span>
#include <stdexcept>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "files/json_reader.h"
#include "tests/own_folder.h"

namespace relumine::files {
namespace {

nlohmann::json parsed(const Json& report) {
    return nlohmann::json::parse(report.text(2));
}

TEST(JsonReader, WhatIsNoTextIsNotQuoted) {
    const std::string text = "{\"versi\xff\x1b\": 1}";
    try {
        static_cast<void>(JsonReader("a.json").parse(std::as_bytes(std::span(text))));
        FAIL() << "accepted";
    } catch (const std::runtime_error& error) {
        const std::string message = error.what();
        EXPECT_NE(message.find("a.json:1: expected"), std::string::npos) << message;
        EXPECT_NE(message.find("versi?"), std::string::npos) << message;
        EXPECT_EQ(message.find_first_of("\xff\x1b"), std::string::npos) << message;
    }
}

TEST(Json, ValuesKeepTheirTypes) {
    const std::uint64_t large = std::numeric_limits<std::uint64_t>::max();
    const Json report = {{"text", "mesh.ply"},
                         {"string", std::string("a\"b")},
                         {"view", std::string_view("view")},
                         {"whole", 6},
                         {"large", large},
                         {"negative", -3L},
                         {"real", 0.5},
                         {"single", 0.1f},
                         {"yes", true},
                         {"nothing", nullptr}};
    const nlohmann::json json = parsed(report);
    EXPECT_EQ(json["text"], "mesh.ply");
    EXPECT_EQ(json["string"], "a\"b");
    EXPECT_EQ(json["view"], "view");
    EXPECT_TRUE(json["whole"].is_number_integer());
    EXPECT_EQ(json["whole"], 6);
    EXPECT_EQ(json["large"], large);
    EXPECT_EQ(json["negative"], -3);
    EXPECT_TRUE(json["real"].is_number_float());
    EXPECT_EQ(json["single"], static_cast<double>(0.1f));
    EXPECT_EQ(json["yes"], true);
    EXPECT_TRUE(json["nothing"].is_null());
}

TEST(Json, Lists) {
    const std::vector<Json> parts = {{{"name", "a"}}, 2, "three"};
    const Json report = {{"vector", glm::vec3(1.0f, 2.0f, 0.25f)},
                         {"numbers", std::vector<double>{0.5, 1.5}},
                         {"texts", std::vector<std::string>{"a", "b"}},
                         {"parts", parts},
                         {"none", std::vector<Json>{}}};
    EXPECT_EQ(parsed(report),
              nlohmann::json::parse(R"({"vector": [1.0, 2.0, 0.25], "numbers": [0.5, 1.5],
                                        "texts": ["a", "b"], "parts": [{"name": "a"}, 2, "three"],
                                        "none": []})"));
}

TEST(Json, FieldsAreReplacedAndSortedInTheText) {
    Json report = {{"b", 1}, {"a", 1}};
    report.set("b", 2);
    update(report, {{"c", {{"deep", true}}}});
    EXPECT_EQ(report.text(2),
              "{\n  \"a\": 1,\n  \"b\": 2,\n  \"c\": {\n    \"deep\": true\n  }\n}");
}

TEST(Json, CopiesAreTheirOwn) {
    Json first = {{"a", 1}};
    Json second = first;
    second.set("a", 2);
    EXPECT_EQ(parsed(first)["a"], 1);
    first = second;
    second.set("a", 3);
    EXPECT_EQ(parsed(first)["a"], 2);
    EXPECT_EQ(Json().size(), 0u);
    EXPECT_EQ(Json(Json::Object{}).text(), "{}");
    EXPECT_NE(first.size(), 0u);
}

TEST(Json, BytesThatAreNoTextAreReplaced) {
    EXPECT_EQ(parsed({{"name", "bad \xff"}})["name"], "bad \xef\xbf\xbd");
}

TEST(Json, KeepsOrderWhereAsked) {
    const Json json = {{"b", Json::Array{1, 0.5}}, {"a", Json::Object{}}};
    EXPECT_EQ(json.text(-1, Json::Order::Set), R"({"b":[1,0.5],"a":{}})");
    EXPECT_EQ(json.text(), R"({"a":{},"b":[1,0.5]})");
    EXPECT_THROW((void)Json("\xff").text(-1, Json::Order::Set, Json::Utf8::Require), JsonError);
}

TEST(Json, ReadsWhatItWrites) {
    const std::string text =
        R"({"b":[true,null,-3,18446744073709551615,0.1,"\u00e4\n"],"a":{"deep":[]}})";
    const Json json = parse_json(text);
    EXPECT_EQ(json.members()[0].first, "b");
    EXPECT_EQ(json.at("b").values()[3].whole(), std::numeric_limits<std::uint64_t>::max());
    EXPECT_EQ(json.at("b").values()[2].number(), -3.0);
    EXPECT_EQ(json.at("b").values()[4].number(), 0.1);
    EXPECT_EQ(json.at("b").values()[5].string(), "\xc3\xa4\n");
    EXPECT_TRUE(json.at("b").values()[0].boolean());
    EXPECT_TRUE(json.at("b").values()[1].type() == Json::Type::Null);
    EXPECT_TRUE(json.at("a").at("deep").type() == Json::Type::Array);
    EXPECT_EQ(nlohmann::json::parse(json.text()), nlohmann::json::parse(text));
    EXPECT_EQ(parse_json(R"({"a":1,"a":2})").at("a").number(), 2.0);
}

TEST(Json, RefusesOtherTypesAndWhatIsNotThere) {
    const Json json = parse_json(R"({"real":1.0,"negative":-1,"list":[1]})");
    EXPECT_THROW((void)json.at("real").whole(), JsonError);
    EXPECT_THROW((void)json.at("negative").whole(), JsonError);
    EXPECT_THROW((void)json.at("real").string(), JsonError);
    EXPECT_THROW((void)json.at("list").boolean(), JsonError);
    EXPECT_THROW((void)json.at("none"), JsonError);
    EXPECT_THROW((void)json.values(), JsonError);
    EXPECT_EQ(json.at("list").find("a"), nullptr);
}

TEST(Json, FaultsOfATextAreNamed) {
    const auto fault = [](const std::string& text) {
        return tests::message_of([&] { (void)parse_json(text); });
    };
    EXPECT_EQ(fault("{\"a\": }"), "a syntax error at byte 7");
    EXPECT_EQ(fault("[1e999]"), "a number out of range");
    EXPECT_EQ(fault(std::string(100, '[') + std::string(100, ']')), "");
    EXPECT_EQ(fault(std::string(1000000, '[')), "more than 100 levels of nesting");
    EXPECT_EQ(fault("[1] 2"), "a syntax error at byte 5");
    EXPECT_EQ(fault(""), "a syntax error at byte 1");
}

} // namespace
} // namespace relumine::files
