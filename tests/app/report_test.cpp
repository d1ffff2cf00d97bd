// Reports as --json prints them.
#include "app/report.h"

#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace relumine::app {
namespace {

nlohmann::json parsed(const Report& report) {
    return nlohmann::json::parse(report.text());
}

TEST(Report, ValuesKeepTheirTypes) {
    const std::uint64_t large = std::numeric_limits<std::uint64_t>::max();
    const Report report = {{"text", "mesh.ply"},
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

TEST(Report, Lists) {
    const std::vector<Report> parts = {{{"name", "a"}}, 2, "three"};
    const Report report = {{"vector", glm::vec3(1.0f, 2.0f, 0.25f)},
                           {"numbers", std::vector<double>{0.5, 1.5}},
                           {"texts", std::vector<std::string>{"a", "b"}},
                           {"parts", parts},
                           {"none", std::vector<Report>{}}};
    EXPECT_EQ(parsed(report),
              nlohmann::json::parse(R"({"vector": [1.0, 2.0, 0.25], "numbers": [0.5, 1.5],
                                        "texts": ["a", "b"], "parts": [{"name": "a"}, 2, "three"],
                                        "none": []})"));
}

TEST(Report, FieldsAreReplacedAndSortedInTheText) {
    Report report = {{"b", 1}, {"a", 1}};
    report.set("b", 2);
    report.update({{"c", {{"deep", true}}}});
    EXPECT_EQ(report.text(), "{\n  \"a\": 1,\n  \"b\": 2,\n  \"c\": {\n    \"deep\": true\n  }\n}");
}

TEST(Report, CopiesAreTheirOwn) {
    Report first = {{"a", 1}};
    Report second = first;
    second.set("a", 2);
    EXPECT_EQ(parsed(first)["a"], 1);
    first = second;
    second.set("a", 3);
    EXPECT_EQ(parsed(first)["a"], 2);
    EXPECT_TRUE(Report().empty());
    EXPECT_EQ(Report().text(), "{}");
    EXPECT_FALSE(first.empty());
}

TEST(Report, BytesThatAreNoTextAreReplaced) {
    EXPECT_EQ(parsed({{"name", "bad \xff"}})["name"], "bad \xef\xbf\xbd");
}

} // namespace
} // namespace relumine::app
