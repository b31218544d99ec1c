// Keys as text and files.
#include "host_sim/ground_station/station/key_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

class KeyFile : public ::testing::Test {
 public:
  KeyFile() {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("screed_key_") +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~KeyFile() override { std::filesystem::remove_all(folder_); }

 protected:
  std::filesystem::path file() const { return folder_ / "key"; }

  std::filesystem::path folder_;
};

TEST(KeyText, ThereAndBack) {
  CommandKey key = test_key();
  EXPECT_EQ(key_text(key), "000102030405060708090A0B0C0D0E0F 1");
  key.robot_id = 200;
  key.bytes[0] = 0xFE;
  EXPECT_EQ(parse_key(key_text(key), "here"), key);
  EXPECT_EQ(parse_key("000102030405060708090a0b0c0d0e0f", "here"), test_key());
}

TEST(KeyText, WhatIsNoKeyIsRefusedWithItsPlace) {
  for (const char* text :
       {"", "00", "000102030405060708090A0B0C0D0E0", "000102030405060708090A0B0C0D0E0G",
        "000102030405060708090A0B0C0D0E0F1", "000102030405060708090A0B0C0D0E0F 256",
        "000102030405060708090A0B0C0D0E0F ", "000102030405060708090A0B0C0D0E0F 1 ",
        "-10102030405060708090A0B0C0D0E0F"}) {
    try {
      parse_key(text, "the place");
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).rfind("the place: ", 0), 0U) << error.what();
    }
  }
}

TEST_F(KeyFile, IsForItsOwnerAloneAndNeverOverwritten) {
  CommandKey key = test_key();
  key.robot_id = 3;
  write_key_file(file(), key);
  struct stat status {};
  ASSERT_EQ(stat(file().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
  EXPECT_EQ(read_key_file(file()), key);
  EXPECT_THROW(write_key_file(file(), test_key()), InputError);
  EXPECT_EQ(read_key_file(file()), key);
}

TEST_F(KeyFile, OneThatOthersMayReadIsRefused) {
  write_key_file(file(), test_key());
  ASSERT_EQ(chmod(file().c_str(), 0640), 0);
  EXPECT_THROW(read_key_file(file()), InputError);
  ASSERT_EQ(chmod(file().c_str(), 0400), 0);
  EXPECT_EQ(read_key_file(file()), test_key());
}

// Its rights are not the point: whoever is told to change them has named another file.
TEST_F(KeyFile, OneThatHoldsNoKeyIsCalledSo) {
  { std::ofstream(file()) << "{\n"; }
  ASSERT_EQ(chmod(file().c_str(), 0644), 0);
  try {
    read_key_file(file());
    ADD_FAILURE() << "it is taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(":1: not a key"), std::string::npos) << error.what();
  }
}

TEST_F(KeyFile, MissingOrEmpty) {
  EXPECT_THROW(read_key_file(file()), InputError);
  { const std::ofstream empty(file()); }
  ASSERT_EQ(chmod(file().c_str(), 0600), 0);
  EXPECT_THROW(read_key_file(file()), InputError);
}

}  // namespace
}  // namespace screed
