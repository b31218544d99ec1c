// Whether this is the build with the address sanitizer, some five times as slow: tests that repeat
// much do less there.
#pragma once

namespace screed::testing {

#if defined(__SANITIZE_ADDRESS__)  // gcc
inline constexpr bool kSanitized = true;
#elif defined(__has_feature)  // clang
#if __has_feature(address_sanitizer)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace screed::testing
