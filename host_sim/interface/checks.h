// What the C interfaces have in common: everything that comes from C is checked, everything that is
// thrown ends before it.
#pragma once

#include <screed/base.h>

#include <atomic>
#include <cstdio>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/height_field.h"

namespace screed::interface {

/// Two threads in one handle.
class Busy : public std::runtime_error {
 public:
  explicit Busy(const std::string& what)
      : std::runtime_error("this " + what + " is in use on another thread; one thread at a time") {}
};

/// What every handle begins with.
struct Handle {
  mutable std::atomic_flag in_use = ATOMIC_FLAG_INIT;
};

/// A handle while a call is at work with it. Throws InputError for a null pointer, Busy.
class Use {
 public:
  Use(const Handle* handle, const char* what) : handle_(handle) {
    if (handle == nullptr) throw InputError(std::string(what) + ": a null pointer");
    if (handle->in_use.test_and_set(std::memory_order_acquire)) throw Busy(what);
  }
  ~Use() { handle_->in_use.clear(std::memory_order_release); }
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;

 private:
  const Handle* handle_;
};

inline screed_status say(screed_error* error, screed_status status, const char* text) {
  if (error != nullptr) {
    error->status = status;
    std::snprintf(error->text, sizeof(error->text), "%s", text);
  }
  return status;
}

/// Does the work; whatever it throws becomes a status and a text.
template <typename Work>
screed_status attempt(screed_error* error, const Work& work) noexcept {
  try {
    work();
    return say(error, SCREED_OK, "");
  } catch (const Busy& busy) {
    return say(error, SCREED_BUSY, busy.what());
  } catch (const InputError& wrong) {
    return say(error, SCREED_BAD_INPUT, wrong.what());
  } catch (const std::bad_alloc&) {
    return say(error, SCREED_NO_MEMORY, "not enough memory");
  } catch (const std::exception& failed) {
    return say(error, SCREED_FAILED, failed.what());
  }
}

/// Unless another thread is at work with it.
template <typename Of>
void destroy(Of* handle) noexcept {
  if (handle != nullptr && !handle->in_use.test_and_set(std::memory_order_acquire)) delete handle;
}

/// Throws InputError "what = value; allowed: range".
void require(bool allowed, const std::string& what, double value, const char* range);
void require_pointer(const void* pointer, const char* what);

/// Heights of a part of a field, row by row from the south, m. Throws InputError.
void copy_heights(const HeightField& field, const screed_rectangle* part, double* heights);

}  // namespace screed::interface
