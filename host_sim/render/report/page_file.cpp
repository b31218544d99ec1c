// Script elements of types that browsers do not execute carry the data.
#include "host_sim/render/report/page_file.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "host_sim/core/base64.h"
#include "host_sim/core/errors.h"

namespace screed {
namespace {

// Where the built page takes the data: tools/report/page.html.
constexpr std::string_view kMark = "<!-- data -->";

template <class T>
std::span<const std::uint8_t> raw_bytes(std::span<const T> numbers) {
  static_assert(std::endian::native == std::endian::little, "the page reads little endian");
  // std::uint8_t may alias any type.
  return {reinterpret_cast<const std::uint8_t*>(numbers.data()), numbers.size_bytes()};
}

std::string read_page(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw InputError(file.string() + ": no such file; make report-page builds the page of reports");
  }
  std::ostringstream text;
  text << stream.rdbuf();
  return std::move(text).str();
}

}  // namespace

std::vector<std::uint8_t> deflated(std::span<const std::uint8_t> bytes) {
  uLongf size = compressBound(bytes.size());
  std::vector<std::uint8_t> result(size);
  if (compress2(result.data(), &size, bytes.data(), bytes.size(), Z_BEST_COMPRESSION) != Z_OK) {
    throw std::runtime_error("zlib: cannot compress");
  }
  result.resize(size);
  return result;
}

void PageFile::add_block(const std::string& name, std::span<const std::uint8_t> bytes) {
  if (std::any_of(blocks_.begin(), blocks_.end(),
                  [&](const Block& block) { return block.name == name; })) {
    throw std::logic_error("two blocks of the name " + name);
  }
  blocks_.push_back({name, base64(deflated(bytes))});
}

void PageFile::add_numbers(const std::string& name, std::span<const float> numbers) {
  add_block(name, raw_bytes(numbers));
}

void PageFile::add_numbers(const std::string& name, std::span<const double> numbers) {
  add_block(name, raw_bytes(numbers));
}

void PageFile::add_numbers(const std::string& name, std::span<const std::uint32_t> numbers) {
  add_block(name, raw_bytes(numbers));
}

std::string PageFile::document(const std::filesystem::path& built_page,
                               std::string_view facts) const {
  std::string page = read_page(built_page);
  const std::size_t at = page.find(kMark);
  if (at == std::string::npos) {
    throw InputError(built_page.string() + ": is no page of reports: it has no " +
                     std::string(kMark));
  }
  std::string data =
      "<script type=\"application/json\" id=\"facts\">" + json_for_script(facts) + "</script>\n";
  for (const Block& block : blocks_) {
    data +=
        "<script type=\"text/plain\" id=\"block-" + block.name + "\">" + block.text + "</script>\n";
  }
  return page.replace(at, kMark.size(), data);
}

std::string json_for_script(std::string_view json) {
  std::string text;
  text.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

}  // namespace screed
