// A page that shows a run, as one file: the built page (tools/report), its facts as JSON, and its
// numbers as compressed blocks. It needs no network.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace screed {

/// Bytes in the format of zlib (RFC 1950), which browsers call "deflate".
std::vector<std::uint8_t> deflated(std::span<const std::uint8_t> bytes);

/// The facts and blocks of a page on their way into the file.
class PageFile {
 public:
  /// Numbers for the script, under a name that its facts name. Throws std::logic_error when there
  /// is one of that name.
  void add_block(const std::string& name, std::span<const std::uint8_t> bytes);
  void add_numbers(const std::string& name, std::span<const float> numbers);
  void add_numbers(const std::string& name, std::span<const double> numbers);
  void add_numbers(const std::string& name, std::span<const std::uint32_t> numbers);

  /// The built page with `facts` (JSON) and the blocks in it. Throws InputError when the built page
  /// does not exist or has no place for them.
  std::string document(const std::filesystem::path& built_page, std::string_view facts) const;

 private:
  struct Block {
    std::string name;
    std::string text;  ///< deflated, base64
  };
  std::vector<Block> blocks_;
};

/// The same text for the inside of a script element: "<" does not occur in it.
std::string json_for_script(std::string_view json);

}  // namespace screed
