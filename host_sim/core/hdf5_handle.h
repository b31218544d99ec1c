// Ownership, errors and attributes of the HDF5 C library, for the session writer and reader only.
//
// Every failure becomes an Hdf5Failure with the library's own reason (that of the operating system
// where it knows one); the users turn it into InputError or RunError with the name of the file.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace screed::h5 {

class Hdf5Failure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Must run before a file is created or opened: keeps the library from printing and from working on
/// at exit. Throws std::bad_alloc where the library would find no room for a file.
void begin();

/// An HDF5 identifier with its closing function. Closing errors are ignored in the destructor; see
/// close().
class Handle {
 public:
  using Close = herr_t (*)(hid_t);

  Handle() = default;
  /// Throws Hdf5Failure "<what>: <reason>" when id is that of a failed call.
  Handle(hid_t id, Close closer, const char* what);
  Handle(Handle&& other) noexcept;
  Handle& operator=(Handle&& other) noexcept;
  ~Handle() { reset(); }

  hid_t get() const { return id_; }
  bool is_open() const { return id_ >= 0; }
  /// Closes now; throws Hdf5Failure when the library could not, which for a file means that data
  /// may be lost.
  void close(const char* what);
  void reset() noexcept;

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

/// Throws Hdf5Failure "<what>: <reason>" for a negative status.
void check(herr_t status, const char* what);

bool has_attribute(hid_t object, const char* name);
/// Whether a link of that name exists directly under the object.
bool has_link(hid_t object, const char* name);

/// Create the attribute, or overwrite the one of that name.
void write_attribute(hid_t object, const char* name, std::uint64_t value);
void write_attribute(hid_t object, const char* name, std::int64_t value);
void write_attribute(hid_t object, const char* name, double value);
/// Create an attribute of UTF-8 text, of any length. Throw Hdf5Failure when it exists, and for a
/// text with a NUL byte.
void write_attribute(hid_t object, const char* name, const std::string& value);
void write_attribute(hid_t object, const char* name, const std::vector<const char*>& values);

/// Each throws Hdf5Failure when the attribute is missing, not a scalar, or of another kind.
std::uint64_t read_uint64(hid_t object, const char* name);
std::int64_t read_int64(hid_t object, const char* name);
double read_double(hid_t object, const char* name);
std::string read_string(hid_t object, const char* name);

}  // namespace screed::h5
