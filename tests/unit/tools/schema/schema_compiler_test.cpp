// The schema compiler: what it refuses, with file and line, and that it takes what is right.
#include <gtest/gtest.h>

#include <string>

#include "host_sim/core/errors.h"
#include "tools/schema/code.h"
#include "tools/schema/dbc.h"
#include "tools/schema/documentation.h"
#include "tools/schema/schema_check.h"

namespace screed::schema {
namespace {

// Line 1 to 11; the message ends in line 7.
constexpr const char* kRight =
    "VERSION \"\"\n"
    "BU_: GROUND ROBOT\n"
    "BO_ 528 ATTITUDE: 8 ROBOT\n"
    " SG_ crc : 0|8@1+ (1,0) [0|255] \"\" GROUND\n"
    " SG_ counter : 8|4@1+ (1,0) [0|15] \"\" GROUND\n"
    " SG_ roll : 16|16@1- (0.01,0) [-180|180] \"deg\" GROUND\n"
    " SG_ mode : 12|4@1+ (1,0) [0|15] \"\" GROUND\n"
    "CM_ BO_ 528 \"Where the robot points.\";\n"
    "BA_DEF_ BO_ \"Protection\" ENUM \"e2e\",\"mac\";\n"
    "BA_DEF_DEF_ \"Protection\" \"e2e\";\n"
    "VAL_ 528 mode 0 \"idle\" 1 \"busy\" ;\n";

/// The schema above with one part of it replaced.
std::string with(const std::string& part, const std::string& other) {
  std::string text = kRight;
  const size_t at = text.find(part);
  EXPECT_NE(at, std::string::npos) << part;
  return text.replace(at, part.size(), other);
}

/// What the compiler says of a schema; empty: nothing.
std::string said_of(const std::string& text) {
  try {
    check_schema(parse_dbc("it.dbc", text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SchemaCompiler, TakesWhatIsRight) {
  EXPECT_EQ(said_of(kRight), "");
}

TEST(SchemaCompiler, RefusesWithFileAndLine) {
  const std::string kRoll = "roll : 16|16@1- (0.01,0) [-180|180] \"deg\" GROUND";
  const auto roll = [&](const std::string& other) { return with(kRoll, other); };
  const struct {
    std::string text;
    const char* says;
  } cases[] = {
      // What decoders disagree on.
      {roll("roll : 23|16@0- (0.01,0) [-180|180] \"deg\" GROUND"),
       "it.dbc:6: ATTITUDE.roll: big endian (@0); "},
      {roll("roll : 16|12@1- (0.01,0) [-20|20] \"deg\" GROUND"),
       "it.dbc:6: ATTITUDE.roll: signed with 12 bits; decoders extend only 8, 16 and 32 alike"},
      {roll("roll m0 : 16|16@1- (0.01,0) [-180|180] \"deg\" GROUND"),
       "it.dbc:6: ATTITUDE.roll: multiplexed (m0); "},
      {roll("roll M : 16|16@1- (0.01,0) [-180|180] \"deg\" GROUND"),
       "it.dbc:6: ATTITUDE.roll: multiplexed (M); "},
      {roll("roll : 16|32@1- (1,0) [-180|180] \"deg\" GROUND") + "SIG_VALTYPE_ 528 roll : 1;\n",
       "it.dbc:6: ATTITUDE.roll: a floating point value; "},
      {roll("roll : 16|40@1+ (1,0) [0|180] \"deg\" GROUND"),
       "it.dbc:6: ATTITUDE.roll: has 40 bits; 1 to 32"},
      {roll("roll : 16|16@1- (0.01,0) [-180|180] \"\" GROUND"),
       "it.dbc:6: ATTITUDE.roll: has no unit; a pure number has the unit \"1\""},
      {with("[0|15] \"\" GROUND\nCM_", "[0|15] \"mm\" GROUND\nCM_"),
       "it.dbc:7: ATTITUDE.mode: names of values and flags have no unit"},
      // Places.
      {roll("roll : 50|16@1- (0.01,0) [-180|180] \"deg\" GROUND"),
       "it.dbc:6: ATTITUDE.roll: ends at bit 66, the message has 64"},
      {with("mode : 12|4", "mode : 14|4"), "it.dbc:7: ATTITUDE.mode: overlaps roll at bit 16"},
      {with("ATTITUDE: 8", "ATTITUDE: 9"), "it.dbc:3: ATTITUDE: 9 bytes; a frame holds 1 to 8"},
      {with("ATTITUDE: 8", "ATTITUDE: 2"), "it.dbc:3: ATTITUDE: a protected message has 3 bytes"},
      {with(" SG_ counter : 8|4@1+ (1,0) [0|15] \"\" GROUND\n", ""),
       "it.dbc:3: ATTITUDE: a protected message has the signal counter : 8|4@1+ (1,0)"},
      {with("counter : 8|4@1+", "counter : 8|3@1+"),
       "it.dbc:5: ATTITUDE: its protection is counter : 8|4@1+ (1,0)"},
      // Ids and names.
      {with("BO_ 528", "BO_ 2560"), "it.dbc:8: no message has the id 528"},
      {std::string(kRight) + "BO_ 2049 X: 8 ROBOT\n", "it.dbc:12: X: id 2049 is above 2047"},
      {std::string(kRight) + "BO_ 2147483649 X: 8 ROBOT\n", "it.dbc:12: X: an extended id; "},
      {std::string(kRight) + "BO_ 560 X: 8 ROBOT\n",
       "it.dbc:12: X: bits 4 to 7 of the id are the node: 0 for the ground, 1 for the robot, not "
       "3"},
      {std::string(kRight) + "BO_ 529 attitude: 8 ROBOT\n",
       "it.dbc:12: attitude: names of messages are capitals, "},
      {std::string(kRight) + "BO_ 529 X: 8 NOBODY\n",
       "it.dbc:12: X: its sender NOBODY is not among the nodes (BU_)"},
      {std::string(kRight) + "BO_ 529 X: 8 ROBOT\n", "it.dbc:12: X: has no comment (CM_ BO_)"},
      {std::string(kRight) + "BO_ 529 X: 8 ROBOT\nCM_ BO_ 529 \"it\";\n",
       "it.dbc:12: X: has no signal"},
      {std::string(kRight) + "BO_ 528 X: 1 ROBOT\n SG_ a : 0|8@1+ (1,0) [0|255] \"1\" GROUND\n"
                             "CM_ BO_ 528 \"it\";\n",
       "it.dbc:12: X: has no comment"},
      {with("mode : 12|4", "roll : 12|4"), "it.dbc:11: names of values is given for ATTITUDE.mode"},
      {with("mode : 12|4", "Mode : 12|4"), "it.dbc:11: names of values is given for ATTITUDE.mode"},
      {roll("Roll : 16|16@1- (0.01,0) [-180|180] \"deg\" GROUND"),
       "it.dbc:6: ATTITUDE.Roll: names of signals are small letters, "},
      {roll("class : 16|16@1- (0.01,0) [-180|180] \"deg\" GROUND"),
       "it.dbc:6: ATTITUDE.class: is a word of C++ or of the generated code"},
      {roll("counter : 16|16@1- (0.01,0) [-180|180] \"deg\" GROUND"),
       "it.dbc:6: the name ATTITUDE.counter is taken"},
      // Numbers.
      {roll("roll : 16|16@1- (0,0) [-180|180] \"deg\" GROUND"),
       "it.dbc:6: ATTITUDE.roll: its scale is not positive"},
      {roll("roll : 16|16@1- (0.0012345678,0) [-1|1] \"deg\" GROUND"),
       "it.dbc:6: ATTITUDE.roll: scale and offset have at most 9 digits"},
      {roll("roll : 16|16@1- (0.01,0) [-360|360] \"deg\" GROUND"),
       "it.dbc:6: ATTITUDE.roll: its range [-360|360] does not fit into 16 bits"},
      {roll("roll : 16|16@1- (0.01,0) [180|180] \"deg\" GROUND"),
       "it.dbc:6: ATTITUDE.roll: its range [180|180] is empty"},
      // Names of values.
      {with("1 \"busy\"", "16 \"busy\""),
       "it.dbc:11: ATTITUDE.mode: the value 16 does not fit into 4 bits"},
      {with("1 \"busy\"", "0 \"busy\""), "it.dbc:11: ATTITUDE.mode: 0 \"busy\" is there twice"},
      {with("1 \"busy\"", "1 \"Very busy\""), "it.dbc:11: ATTITUDE.mode: 'Very busy': names of "},
      // The language.
      {with("VERSION", "VERSIONS"), "it.dbc:1: 'VERSIONS' is not understood here"},
      {with("16|16@1-", "16,16@1-"), "it.dbc:6: '|' belongs here, not ','"},
      {with("\"deg\"", "deg"), "it.dbc:6: a text in quotation marks belongs here, not 'deg'"},
      {std::string(kRight) + "CM_ \"without\nan end;\n", "it.dbc:12: this string has no end"},
      {with("(0.01,0)", "(0.0.1,0)"), "it.dbc:6: '0.0.1' is not a decimal number"},
      {with("ATTITUDE: 8", "ATTITUDE: eight"), "it.dbc:3: a number belongs here, not 'eight'"},
      {with("ATTITUDE: 8", "ATTITUDE: \x01"), "it.dbc:3: a byte that is not text (1)"},
      {with("\"Protection\" \"e2e\"", "\"Protection\" \"none\""),
       "it.dbc:10: 'none' is not a value of this attribute"},
      {std::string(kRight) + "BA_ \"Colour\" BO_ 528 1;\n",
       "it.dbc:12: no attribute \"Colour\" is defined"},
      {std::string(kRight) + "BU_SG_REL_ : 3;\n", "it.dbc:12: 'BU_SG_REL_' is not understood"},
      {" SG_ lost : 0|8@1+ (1,0) [0|255] \"\" X\n", "it.dbc:1: a signal outside of a message"},
      {"BU_: A\n", "it.dbc:1: there is no message (BO_) in it"},
  };
  for (const auto& one : cases) {
    const std::string said = said_of(one.text);
    EXPECT_EQ(said.substr(0, std::string(one.says).size()), one.says) << said;
  }
}

TEST(SchemaCompiler, RefusesTwoMessagesOfOneIdOrName) {
  const std::string second =
      "BU_: ROBOT\n"
      "BO_ 528 A: 1 ROBOT\n SG_ a : 0|8@1+ (1,0) [0|255] \"1\" X\n"
      "BO_ %: 1 ROBOT\n SG_ a : 0|8@1+ (1,0) [0|255] \"1\" X\n"
      "CM_ BO_ 528 \"it\";\n";
  const auto of = [&](const std::string& head, const std::string& tail) {
    std::string text = second + tail;
    return said_of(text.replace(text.find('%'), 1, head));
  };
  EXPECT_EQ(of("529 A", "CM_ BO_ 529 \"it\";\n"), "it.dbc:4: the name A is taken");
  // A comment reaches the first message of an id only; so the second one is named either way.
  EXPECT_EQ(of("528 B", "").substr(0, 12), "it.dbc:4: B:");
}

TEST(SchemaCompiler, RefusesFlagsThatAreNoFieldOfTheirOwn) {
  const auto of = [](const std::string& signals) {
    return said_of(
        "BU_: ROBOT\n"
        "BO_ 528 A: 2 ROBOT\n" +
        signals +
        "CM_ BO_ 528 \"it\";\n"
        "BA_DEF_ SG_ \"Flags\" STRING;\n"
        "BA_ \"Flags\" SG_ 528 a \"all\";\n"
        "BA_ \"Flags\" SG_ 528 b \"all\";\n");
  };
  const std::string a = " SG_ a : 0|1@1+ (1,0) [0|1] \"\" X\n";
  EXPECT_EQ(of(a + " SG_ b : 1|1@1+ (1,0) [0|1] \"\" X\n"), "");
  EXPECT_EQ(of(a + " SG_ b : 9|1@1+ (1,0) [0|1] \"\" X\n"), "");
  EXPECT_EQ(of(a + " SG_ b : 1|2@1+ (1,0) [0|1] \"\" X\n"),
            "it.dbc:4: A.b: a flag has one bit, unsigned");
  EXPECT_EQ(of(" SG_ a : 1|1@1+ (1,0) [0|1] \"\" X\n SG_ b : 2|1@1+ (1,0) [0|1] \"\" X\n"),
            "it.dbc:3: A.all: flags begin with a byte");
  EXPECT_EQ(of(a + " SG_ b : 1|1@1+ (1,0) [0|1] \"\" X\n SG_ c : 7|1@1+ (1,0) [0|1] \"1\" X\n"),
            "it.dbc:5: A.c: is in the way of the flags all, which fill 1 bytes");
}

TEST(SchemaCompiler, NumbersAreExact) {
  const auto scale_of = [](const std::string& text) {
    const Database it = parse_dbc("it.dbc", with("(0.01,0)", "(" + text + ",0)"));
    return it.messages[0].signals[2].scale;
  };
  const struct {
    const char* text;
    std::int64_t mantissa;
    int decimals;
    const char* shown;
  } cases[] = {{"0.0625", 625, 4, "0.0625"}, {"1E-2", 1, 2, "0.01"}, {"1.50", 15, 1, "1.5"},
               {"2e3", 2000, 0, "2000"},     {"+7", 7, 0, "7"},      {"-0.5", -5, 1, "-0.5"},
               {"1.25e1", 125, 1, "12.5"},   {"100", 100, 0, "100"}};
  for (const auto& one : cases) {
    const Decimal got = scale_of(one.text);
    EXPECT_EQ(got.mantissa, one.mantissa) << one.text;
    EXPECT_EQ(got.decimals, one.decimals) << one.text;
    EXPECT_EQ(got.text(), one.shown);
  }
  EXPECT_THROW(scale_of("99999999999999999999"), InputError);
  EXPECT_THROW(scale_of("1e30"), InputError);
}

TEST(SchemaCompiler, WritesTheCodeOfTheFieldsPlace) {
  const Database it = parse_dbc("it.dbc", kRight);
  const std::string code = message_code(it);
  for (const char* line : {"  kIdAttitude = 0x210,\n", "  enum : uint8_t { kSize = 8 };\n",
                           "    put_s16(data + 2, roll);\n",
                           "    data[1] = static_cast<uint8_t>(((mode & 0x0FU) << 4));\n",
                           "    message.mode = static_cast<uint8_t>((data[1] >> 4));\n"}) {
    EXPECT_NE(code.find(line), std::string::npos) << line << code;
  }
  const std::string tables = host_tables(it);
  EXPECT_NE(tables.find("\"ATTITUDE\", \"attitude\""), std::string::npos) << tables;
  EXPECT_NE(tables.find("16, 16, true, 2, 1, 0, {}}"), std::string::npos) << tables;
}

TEST(SchemaCompiler, WritesEnumerationsOfValuesAndFlags) {
  const std::string flags = with(" SG_ mode : 12|4@1+ (1,0) [0|15] \"\" GROUND\n",
                                 " SG_ mode : 12|4@1+ (1,0) [0|15] \"\" GROUND\n"
                                 " SG_ hot : 32|1@1+ (1,0) [0|1] \"\" GROUND\n"
                                 " SG_ wet_feet : 41|1@1+ (1,0) [0|1] \"\" GROUND\n") +
                            "CM_ SG_ 528 mode \"what it does\";\n"
                            "CM_ SG_ 528 hot \"beyond 60 degC\";\n"
                            "BA_DEF_ SG_ \"Flags\" STRING;\n"
                            "BA_ \"Flags\" SG_ 528 hot \"faults\";\n"
                            "BA_ \"Flags\" SG_ 528 wet_feet \"faults\";\n";
  ASSERT_EQ(said_of(flags), "");
  const std::string code = value_code(parse_dbc("it.dbc", flags));
  for (const char* part :
       {"/// ATTITUDE.mode: what it does\nenum class AttitudeMode : uint8_t {\n  kIdle = 0,\n"
        "  kBusy = 1,\n};\nconstexpr uint8_t kAttitudeModeMax = 1;",
        "struct AttitudeFaults {\n  enum : uint16_t {\n    kHot = 1U << 0,  ///< beyond 60 degC\n"
        "    kWetFeet = 1U << 9,\n  };\n};\n"}) {
    EXPECT_NE(code.find(part), std::string::npos) << part << code;
  }
  EXPECT_EQ(code.find("#define"), std::string::npos) << "a list is for classes alone" << code;
  EXPECT_EQ(code.find("#include \""), std::string::npos) << "it stands below every layer" << code;
}

TEST(SchemaCompiler, WritesTheListOfClassesThatValuesName) {
  const auto of = [](const std::string& folder) {
    return with("\"busy\"", "\"very_busy\"") + "BA_DEF_ SG_ \"ClassFolder\" STRING;\n" +
           "BA_ \"ClassFolder\" SG_ 528 mode \"" + folder + "\";\n";
  };
  const Database it = parse_dbc("it.dbc", of("firmware/modes"));
  check_schema(it);
  EXPECT_NE(value_code(it).find("enum class AttitudeMode : uint8_t;\n"), std::string::npos)
      << "declared: its values stand apart" << value_code(it);
  const std::string code = class_values(it);
  EXPECT_NE(code.find("enum class AttitudeMode : uint8_t {\n  kIdle = 0,\n"), std::string::npos)
      << code;
  EXPECT_NE(code.find("#define SCREED_ATTITUDE_MODE(X) \\\n  X(0, idle, Idle) \\\n"
                      "  X(1, very_busy, VeryBusy)\n"),
            std::string::npos)
      << code;
  const std::string includes = class_includes(it);
  EXPECT_NE(includes.find("\n#include \"firmware/modes/idle.h\"\n"
                          "#include \"firmware/modes/very_busy.h\"\n"),
            std::string::npos)
      << includes;

  for (const char* wrong : {"/firmware", "firmware/", "../firmware", "Firmware"}) {
    EXPECT_EQ(said_of(of(wrong)), "it.dbc:7: ATTITUDE.mode: its ClassFolder '" +
                                      std::string(wrong) +
                                      "' is no folder of small letters, digits, _ and / below the "
                                      "project");
  }
  std::string word = of("firmware/modes");
  EXPECT_EQ(said_of(word.replace(word.find("very_busy"), 9, "return")),
            "it.dbc:11: ATTITUDE.mode: 'return' is a word of C++, so it can be no class");
  EXPECT_EQ(said_of(with("VAL_ 528 mode 0 \"idle\" 1 \"busy\" ;\n",
                         "BA_DEF_ SG_ \"ClassFolder\" STRING;\n"
                         "BA_ \"ClassFolder\" SG_ 528 roll \"firmware\";\n")),
            "it.dbc:6: ATTITUDE.roll: has the attribute ClassFolder, but no names of values "
            "(VAL_)");
}

TEST(SchemaCompiler, WritesPeriodsAndHowManyTheRobotKeeps) {
  const std::string text = std::string(kRight) +
                           "BO_ 2 PING: 3 GROUND\n"
                           " SG_ crc : 0|8@1+ (1,0) [0|255] \"\" ROBOT\n"
                           " SG_ counter : 8|4@1+ (1,0) [0|15] \"\" ROBOT\n"
                           " SG_ a : 16|8@1+ (1,0) [0|255] \"1\" ROBOT\n"
                           "CM_ BO_ 2 \"The ground lives.\";\n"
                           "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 65535;\n"
                           "BA_DEF_DEF_ \"GenMsgCycleTime\" 0;\n"
                           "BA_ \"GenMsgCycleTime\" BO_ 2 200;\n";
  ASSERT_EQ(said_of(text), "");
  const auto has = [](const std::string& code, const std::string& part) {
    return code.find(part) != std::string::npos;
  };
  std::string code = message_code(parse_dbc("it.dbc", text));
  EXPECT_TRUE(has(code, "kPeriodicMessages = 0;")) << "the ground's do not count" << code;
  EXPECT_TRUE(has(code, "kPeriod_ms = 200 };")) << code;
  code = message_code(parse_dbc("it.dbc", text + "BA_ \"GenMsgCycleTime\" BO_ 528 40;\n"));
  EXPECT_TRUE(has(code, "kPeriodicMessages = 1;")) << code;
  EXPECT_TRUE(has(code, "kPeriod_ms = 40 };")) << code;
}

TEST(SchemaCompiler, WritesWiresharksTablesWithGapsAndAllRobots) {
  const auto tables = wireshark_tables(parse_dbc("it.dbc", kRight));
  const auto has = [&](const char* table, const std::string& line) {
    return tables.at(table).find("\n" + line + "\n") != std::string::npos;
  };
  EXPECT_TRUE(has("Signal_PDU_identifiers", R"("210","ATTITUDE")"));
  EXPECT_TRUE(has("Signal_PDU_signal_list",
                  R"("210","5","3","roll [deg]","attitude.roll","int","FALSE","16","16",)"
                  R"("0.01","0","FALSE","-1","FALSE")"))
      << tables.at("Signal_PDU_signal_list");
  EXPECT_TRUE(has("Signal_PDU_signal_list",
                  R"("210","5","4","unused","attitude.unused4","uint","FALSE","32","32",)"
                  R"("1","0","FALSE","-1","TRUE")"));
  EXPECT_TRUE(has("Signal_PDU_signal_values", R"("210","2","2","1","1","busy")"));
  EXPECT_TRUE(has("Signal_PDU_Binding_CAN", R"("210","0","210")"));
  EXPECT_TRUE(has("Signal_PDU_Binding_CAN", R"("2f0","0","210")"));
  EXPECT_FALSE(has("Signal_PDU_Binding_CAN", R"("200","0","210")"));
}

TEST(SchemaCompiler, RenewsThePageBetweenItsMarks) {
  const Database it = parse_dbc("it.dbc", kRight);
  const std::string marks =
      "before\n<!-- messages: made by `make telemetry-page` -->\nold\n<!-- end of messages "
      "-->\nafter\n";
  const std::string page = renewed_page("it.md", marks, it);
  EXPECT_EQ(page.substr(0, 7), "before\n");
  EXPECT_EQ(page.substr(page.size() - 6), "after\n");
  EXPECT_EQ(page.find("old"), std::string::npos);
  EXPECT_NE(page.find("| 0x210 | ATTITUDE | robot | on occasion | 8 | Where the robot points. |\n"),
            std::string::npos)
      << page;
  EXPECT_NE(page.find("|  | mode | 12..15 | u4 |  |  | 0 `idle`, 1 `busy` |\n"), std::string::npos)
      << page;
  EXPECT_EQ(renewed_page("it.md", page, it), page) << "made anew it is the same";
  EXPECT_THROW(renewed_page("it.md", "no marks", it), InputError);
}

}  // namespace
}  // namespace screed::schema
