// The HDF5 C library behind RAII and exceptions.
#include "host_sim/core/hdf5_handle.h"

#include <algorithm>
#include <cstring>
#include <string_view>
#include <utility>

#include "host_sim/core/memory_room.h"

namespace screed::h5 {
namespace {

struct Reason {
  std::string innermost;
  std::string system;  ///< the operating system's words, when some level of the stack quotes them
};

herr_t collect(unsigned level, const H5E_error2_t* error, void* data) {
  auto& reason = *static_cast<Reason*>(data);
  const std::string_view text = error->desc == nullptr ? "" : error->desc;
  if (level == 0) reason.innermost = text;
  constexpr std::string_view kQuote = "error message = '";
  if (const auto at = text.find(kQuote); at != std::string_view::npos && reason.system.empty()) {
    const std::string_view rest = text.substr(at + kQuote.size());
    reason.system = rest.substr(0, rest.find('\''));
  }
  return 0;
}

[[noreturn]] void fail(const char* what) {
  Reason reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, collect, &reason);
  H5Eclear2(H5E_DEFAULT);
  std::string text = reason.system;
  // The library's own words are about its code, not about the user's file.
  if (text.empty() && !reason.innermost.empty())
    text = "the file is damaged (HDF5: " + reason.innermost + ")";
  throw Hdf5Failure(text.empty() ? std::string(what) : std::string(what) + ": " + text);
}

Handle scalar_space() {
  return {H5Screate(H5S_SCALAR), H5Sclose, "cannot create a data space"};
}

/// UTF-8 text of so many bytes. Variable length would be handier, but lives in the one part of a
/// file without checksums.
Handle text_type(std::size_t bytes) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "cannot create a text type");
  check(H5Tset_size(type.get(), bytes + 1), "cannot create a text type");
  check(H5Tset_strpad(type.get(), H5T_STR_NULLTERM), "cannot create a text type");
  check(H5Tset_cset(type.get(), H5T_CSET_UTF8), "cannot create a text type");
  return type;
}

Handle create_attribute(hid_t object, const char* name, const Handle& type, const Handle& space) {
  return {H5Acreate2(object, name, type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
          name};
}

void write_number(hid_t object, const char* name, hid_t file_type, hid_t memory_type,
                  const void* value) {
  const Handle attribute = has_attribute(object, name)
                               ? Handle(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, name)
                               : Handle(H5Acreate2(object, name, file_type, scalar_space().get(),
                                                   H5P_DEFAULT, H5P_DEFAULT),
                                        H5Aclose, name);
  check(H5Awrite(attribute.get(), memory_type, value), name);
}

Handle open_scalar(hid_t object, const char* name) {
  if (!has_attribute(object, name)) {
    throw Hdf5Failure("attribute '" + std::string(name) + "' is missing");
  }
  Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, name);
  const Handle space(H5Aget_space(attribute.get()), H5Sclose, name);
  if (H5Sget_simple_extent_npoints(space.get()) != 1) {
    throw Hdf5Failure("attribute '" + std::string(name) + "' is not a single value");
  }
  return attribute;
}

template <class T>
T read_number(hid_t object, const char* name, hid_t memory_type, H5T_class_t kind) {
  const Handle attribute = open_scalar(object, name);
  const Handle type(H5Aget_type(attribute.get()), H5Tclose, name);
  if (H5Tget_class(type.get()) != kind) {
    throw Hdf5Failure("attribute '" + std::string(name) + "' is not " +
                      (kind == H5T_INTEGER ? "an integer" : "a floating-point number"));
  }
  T value{};
  check(H5Aread(attribute.get(), memory_type, &value), name);
  return value;
}

}  // namespace

void begin() {
  // After a failed flush (disk full) the library would try again at exit, and say so on stderr.
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  // What a file needs at first, and more. Short of it the library ends with a segmentation fault.
  check_memory(8U << 20U);
}

Handle::Handle(hid_t id, Close closer, const char* what) : id_(id), close_(closer) {
  if (id_ < 0) fail(what);
}

Handle::Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}

Handle& Handle::operator=(Handle&& other) noexcept {
  if (this != &other) {
    reset();
    id_ = std::exchange(other.id_, -1);
    close_ = other.close_;
  }
  return *this;
}

void Handle::close(const char* what) {
  if (id_ >= 0 && close_(std::exchange(id_, -1)) < 0) fail(what);
}

void Handle::reset() noexcept {
  if (id_ >= 0) close_(std::exchange(id_, -1));
}

void check(herr_t status, const char* what) {
  if (status < 0) fail(what);
}

bool has_attribute(hid_t object, const char* name) {
  const htri_t exists = H5Aexists(object, name);
  if (exists < 0) fail(name);
  return exists > 0;
}

bool has_link(hid_t object, const char* name) {
  const htri_t exists = H5Lexists(object, name, H5P_DEFAULT);
  if (exists < 0) fail(name);
  return exists > 0;
}

void write_attribute(hid_t object, const char* name, std::uint64_t value) {
  write_number(object, name, H5T_STD_U64LE, H5T_NATIVE_UINT64, &value);
}

void write_attribute(hid_t object, const char* name, std::int64_t value) {
  write_number(object, name, H5T_STD_I64LE, H5T_NATIVE_INT64, &value);
}

void write_attribute(hid_t object, const char* name, double value) {
  write_number(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

void write_attribute(hid_t object, const char* name, const std::string& value) {
  if (value.find('\0') != std::string::npos) {
    throw Hdf5Failure("the text of '" + std::string(name) + "' contains a NUL byte");
  }
  const Handle type = text_type(value.size());
  const Handle attribute = create_attribute(object, name, type, scalar_space());
  check(H5Awrite(attribute.get(), type.get(), value.c_str()), name);
}

void write_attribute(hid_t object, const char* name, const std::vector<const char*>& values) {
  std::size_t longest = 0;
  for (const char* value : values) longest = std::max(longest, std::strlen(value));
  const std::size_t width = longest + 1;
  std::vector<char> text(width * values.size(), '\0');
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::memcpy(&text[i * width], values[i], std::strlen(values[i]));
  }
  const hsize_t count = values.size();
  const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose, name);
  const Handle type = text_type(longest);
  const Handle attribute = create_attribute(object, name, type, space);
  check(H5Awrite(attribute.get(), type.get(), text.data()), name);
}

std::uint64_t read_uint64(hid_t object, const char* name) {
  return read_number<std::uint64_t>(object, name, H5T_NATIVE_UINT64, H5T_INTEGER);
}

std::int64_t read_int64(hid_t object, const char* name) {
  return read_number<std::int64_t>(object, name, H5T_NATIVE_INT64, H5T_INTEGER);
}

double read_double(hid_t object, const char* name) {
  return read_number<double>(object, name, H5T_NATIVE_DOUBLE, H5T_FLOAT);
}

std::string read_string(hid_t object, const char* name) {
  const Handle attribute = open_scalar(object, name);
  // The file's own type: the library converts neither between character sets nor between fixed and
  // variable length.
  const Handle type(H5Aget_type(attribute.get()), H5Tclose, name);
  if (H5Tget_class(type.get()) != H5T_STRING) {
    throw Hdf5Failure("attribute '" + std::string(name) + "' is not a text");
  }
  if (H5Tis_variable_str(type.get()) > 0) {
    char* text = nullptr;
    check(H5Aread(attribute.get(), type.get(), &text), name);
    std::string value = text == nullptr ? "" : text;
    H5free_memory(text);
    return value;
  }
  std::string value(H5Tget_size(type.get()), '\0');
  check(H5Aread(attribute.get(), type.get(), value.data()), name);
  if (const auto end = value.find('\0'); end != std::string::npos) value.resize(end);
  return value;
}

}  // namespace screed::h5
