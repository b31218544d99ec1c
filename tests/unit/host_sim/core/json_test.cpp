// JSON values, and their bytes as text.
#include "host_sim/core/json.h"

#include <gtest/gtest.h>

#include <bit>
#include <cfloat>
#include <cmath>
#include <limits>
#include <random>
#include <sstream>

namespace screed {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Where the reading of a text ends; nothing where it is JSON.
std::size_t error_byte(const std::string& text) {
  try {
    Json::parse(text);
  } catch (const JsonSyntaxError& error) {
    EXPECT_NE(std::string(error.what()), "");
    return error.byte;
  }
  return 0;
}

TEST(Json, NumbersAreWrittenShort) {
  const Json json = {0,    -1,   1.0,  0.1,     -0.0,      1e-9,  1e15,     1e14,
                     0.1F, 1e-5, 1e-4, 2.5e100, 1.0 / 3.0, 1e300, INT8_MIN, std::uint16_t{65535}};
  EXPECT_EQ(json.dump(),
            "[0,-1,1.0,0.1,-0.0,1e-09,1e+15,100000000000000.0,0.10000000149011612,1e-05,0.0001,"
            "2.5e+100,0.3333333333333333,1e+300,-128,65535]");
  EXPECT_EQ(Json({kNan, HUGE_VAL, -HUGE_VAL}).dump(), "[null,null,null]");
}

TEST(Json, NumbersReadBackToTheSameBits) {
  std::vector<double> numbers = {0.0, -0.0, DBL_MIN, DBL_MAX, -DBL_MAX, DBL_EPSILON, 5e-324, 1e23};
  std::mt19937_64 random(1);
  while (numbers.size() < 20000) {
    const auto number = std::bit_cast<double>(random());
    if (std::isfinite(number)) numbers.push_back(number);
  }
  const auto back = Json::parse(Json(numbers).dump()).get<std::vector<double>>();
  ASSERT_EQ(back.size(), numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back[i]), std::bit_cast<std::uint64_t>(numbers[i]));
  }
}

TEST(Json, IntegersKeepAllTheirBits) {
  const std::string text = "[-9223372036854775808,9223372036854775807,18446744073709551615]";
  const Json json = Json::parse(text);
  EXPECT_EQ(json.dump(), text);
  EXPECT_EQ(json[0].get<std::int64_t>(), INT64_MIN);
  EXPECT_EQ(json[1].get<std::int64_t>(), INT64_MAX);
  EXPECT_EQ(json[2].get<std::uint64_t>(), UINT64_MAX);
  EXPECT_EQ(json, Json({INT64_MIN, INT64_MAX, UINT64_MAX}));
  EXPECT_TRUE(json[0].is_number_integer() && !json[0].is_number_unsigned());
  EXPECT_TRUE(json[2].is_number_unsigned());
  EXPECT_FALSE(Json::parse("18446744073709551616").is_number_integer());
}

TEST(Json, NumbersAreConvertedAndComparedAcrossTheirKinds) {
  EXPECT_EQ(Json::parse("3").get<float>(), 3.0F);
  EXPECT_EQ(Json::parse("-2.75").get<int>(), -2);
  EXPECT_EQ(Json(3), 3.0);
  EXPECT_EQ(Json(3U), 3);
  EXPECT_NE(Json(UINT64_MAX), -1);
  EXPECT_LT(Json(-1), UINT64_MAX);
  EXPECT_GT(Json(UINT64_MAX), INT64_MAX);
  EXPECT_LE(Json(2), 2.0);
  EXPECT_LT(Json("a"), "b");
  EXPECT_NE(Json(kNan), kNan);
  EXPECT_NE(Json("3"), 3);
  EXPECT_FALSE(Json(nullptr) < Json(1));
  EXPECT_NE(Json(0), false);
}

TEST(Json, TextsAreEscaped) {
  const std::string text = "\"\\/\b\f\n\r\t\x01\x7f \u20ac\U0001f600";
  const std::string written = "\"\\\"\\\\/\\b\\f\\n\\r\\t\\u0001\x7f \u20ac\U0001f600\"";
  EXPECT_EQ(Json(text).dump(), written);
  EXPECT_EQ(Json::parse(written).text(), text);
  EXPECT_EQ(Json::parse(R"("\u20ac\ud83d\ude00\/")").text(), "\u20ac\U0001f600/");
  const std::string with_nul("a\0b", 3);
  EXPECT_EQ(Json(with_nul).dump(), R"("a\u0000b")");
  EXPECT_EQ(Json::parse(R"("a\u0000b")").text(), with_nul);
  EXPECT_EQ(Json({{"\n", 1}}).dump(), R"({"\n":1})");
}

TEST(Json, WhatIsNotUtf8IsRefusedOrReplaced) {
  const Json json = {{"na\xffme", "\xc3(\xe2\x82"}};
  EXPECT_THROW(json.dump(), JsonError);
  EXPECT_EQ(json.dump(-1, Json::BadText::kReplace), "{\"na\ufffdme\":\"\ufffd(\ufffd\"}");
  EXPECT_EQ(error_byte("[\"\xff\"]"), 3U);
}

TEST(Json, IsWrittenInOneLineOrInLevels) {
  const Json json = {
      {"list", {1, {{"a", true}}, Json::array()}}, {"none", nullptr}, {"object", Json::object()}};
  EXPECT_EQ(json.dump(), R"({"list":[1,{"a":true},[]],"none":null,"object":{}})");
  EXPECT_EQ(json.dump(2), R"({
  "list": [
    1,
    {
      "a": true
    },
    []
  ],
  "none": null,
  "object": {}
})");
  EXPECT_EQ(json.dump(0),
            "{\n\"list\": [\n1,\n{\n\"a\": true\n},\n[]\n],\n\"none\": null,\n"
            "\"object\": {}\n}");
  std::ostringstream out;
  out << json;
  EXPECT_EQ(out.str(), json.dump());
}

TEST(Json, BracesMakeAnObjectOfPairsThatBeginWithATextElseAList) {
  EXPECT_EQ(Json({{"x", 1}, {"y", 2}}).dump(), R"({"x":1,"y":2})");
  EXPECT_EQ(Json({"x", 1}).dump(), R"(["x",1])");
  EXPECT_EQ(Json({"x", "y"}).dump(), R"(["x","y"])");
  EXPECT_EQ(Json({{"x", 1}, {2, 3}}).dump(), R"([["x",1],[2,3]])");
  EXPECT_EQ(Json::array({Json::array({"x", 1})}).dump(), R"([["x",1]])");
  EXPECT_EQ((Json{{"x", {{"y", {{"z", {1, 2}}}}}}}).dump(), R"({"x":{"y":{"z":[1,2]}}})");
  EXPECT_EQ(Json({{"x", 1}, {"x", 2}}).dump(), R"({"x":2})");
  EXPECT_TRUE(Json{}.is_null());
  EXPECT_EQ(Json(std::vector<std::vector<std::string>>{{"a"}, {}}).dump(), R"([["a"],[]])");
}

TEST(Json, BracesCopyNothing) {
  Json list = {1, 2, 3};
  const Json* const place = list.begin();
  const Json json = {{"a", {{"b", std::move(list)}}}};
  EXPECT_EQ(json["a"]["b"].begin(), place);
}

TEST(Json, MembersKeepTheirOrder) {
  Json json = Json::parse(R"({"z":1,"a":{"y":2,"b":3},"m":[{"d":4,"c":5}]})");
  json["b"] = 6;
  json["z"] = 7;
  json.update({{"m", 8}, {"c", 9}});
  EXPECT_EQ(json.dump(), R"({"z":7,"a":{"y":2,"b":3},"m":8,"b":6,"c":9})");
  json.erase("a");
  json.erase("none");
  EXPECT_EQ(json.dump(), R"({"z":7,"m":8,"b":6,"c":9})");
  Json sorted = Json::parse(R"({"z":1,"a":{"y":2,"b":3},"m":[{"d":4,"c":5}]})");
  sorted.sort_members();
  EXPECT_EQ(sorted.dump(), R"({"a":{"b":3,"y":2},"m":[{"c":5,"d":4}],"z":1})");
}

TEST(Json, OfMembersOfOneNameTheLastCounts) {
  EXPECT_EQ(Json::parse(R"({"a":1,"b":2,"a":[3],"c":4,"b":5,"a":6})").dump(),
            R"({"a":6,"b":5,"c":4})");
}

// Quadratic work would take minutes.
TEST(Json, ManyMembersAreRead) {
  constexpr int kMembers = 200000;
  std::string text = "{";
  for (int i = 0; i < kMembers; ++i) text += "\"" + std::to_string(i / 2) + "\":0,";
  text.back() = '}';
  EXPECT_EQ(Json::parse(text).size(), std::size_t{kMembers / 2});
}

TEST(Json, SaysWhereATextIsNoJson) {
  EXPECT_EQ(error_byte("[1, 2]"), 0U);
  EXPECT_EQ(error_byte(""), 1U);
  EXPECT_EQ(error_byte("[1,\n 2,]"), 8U);
  EXPECT_EQ(error_byte("{\"a\":1} x"), 9U);
  EXPECT_EQ(error_byte("[1] // no"), 5U);
  EXPECT_EQ(error_byte("nul"), 4U);
  EXPECT_EQ(error_byte("[1e999]"), 6U);
  EXPECT_EQ(error_byte("NaN"), 1U);
  EXPECT_TRUE(Json::parse_or_null("[1,").is_null());
  std::istringstream cut("{\"a\":");
  EXPECT_TRUE(Json::parse_or_null(cut).is_null());
  std::istringstream whole(" {\"a\": 1}\n");
  EXPECT_EQ(Json::parse_or_null(whole)["a"], 1);
}

TEST(Json, CommentsArePassedOverWhereAllowed) {
  EXPECT_EQ(Json::parse("[1, // one\n /* two */ 2]", true), Json({1, 2}));
  EXPECT_THROW(Json::parse("[1 /* one */]"), JsonSyntaxError);
}

TEST(Json, NeedsNoStackForDeepNesting) {
  constexpr std::size_t kDepth = 300'000;
  const std::string lists = std::string(kDepth, '[') + std::string(kDepth, ']');
  EXPECT_EQ(Json::parse(lists).size(), 1U);
  std::string objects;
  for (std::size_t i = 0; i < kDepth; ++i) objects += "{\"a\":[";
  EXPECT_EQ(error_byte(objects), objects.size() + 1);
}

TEST(Json, WhatIsMissingOrOfAnotherKindIsSaid) {
  const Json json = {{"text", "t"}, {"number", 1.5}, {"list", {1}}, {"none", nullptr}};
  EXPECT_EQ(json.find("gone"), nullptr);
  EXPECT_FALSE(json.contains("gone"));
  EXPECT_THROW(json.at("gone"), JsonError);
  EXPECT_THROW(json["gone"], JsonError);
  EXPECT_THROW(json["list"][1], JsonError);
  EXPECT_THROW(json["list"]["a"], JsonError);
  EXPECT_THROW(json[0], JsonError);
  EXPECT_THROW(json["text"].get<double>(), JsonError);
  EXPECT_THROW(json["number"].text(), JsonError);
  EXPECT_THROW(json["number"].get<bool>(), JsonError);
  EXPECT_THROW(json["none"].get<int>(), JsonError);
  EXPECT_THROW(json["text"].get<std::vector<int>>(), JsonError);
  EXPECT_THROW(json["text"].begin(), JsonError);
  EXPECT_THROW(json["list"].items(), JsonError);
  EXPECT_THROW(Json(1).push_back(2), JsonError);
  EXPECT_THROW(Json(1)["a"], JsonError);
  EXPECT_THROW(Json::array().back(), JsonError);
  EXPECT_EQ(json.value("gone", 7), 7);
  EXPECT_EQ(json.value("gone", "word"), "word");
  EXPECT_EQ(json.value("text", "word"), "t");
  EXPECT_THROW(json.value("text", 7), JsonError);
  EXPECT_THROW(json["list"].value("a", 7), JsonError);
  EXPECT_EQ(json.find("gone"), json["list"].find("a"));
  EXPECT_EQ(json.size(), 4U);
}

TEST(Json, NullBecomesWhatIsPutIntoIt) {
  Json json;
  EXPECT_TRUE(json.empty() && json.items().empty());
  for (const Json& value : json) ADD_FAILURE() << value;
  json["a"]["b"].push_back(1);
  json["a"]["b"].push_back({{"c", 2}});
  json["a"]["b"].back()["d"] = 3;
  EXPECT_EQ(json.dump(), R"({"a":{"b":[1,{"c":2,"d":3}]}})");
}

TEST(Json, CopiesAreOnTheirOwn) {
  Json first = {{"list", {1, "two"}}};
  Json second = first;
  second["list"].push_back(3);
  EXPECT_EQ(first["list"].size(), 2U);
  EXPECT_NE(first, second);
  second = second["list"];
  EXPECT_EQ(second.dump(), R"([1,"two",3])");
  const Json taken = std::move(second);
  EXPECT_EQ(taken.size(), 3U);
  EXPECT_TRUE(second.is_null());  // NOLINT(bugprone-use-after-move): what a move leaves is null
}

}  // namespace
}  // namespace screed
