// What the core is given at its start and keeps.
#pragma once

namespace screed {

/// On the robot such things lie in one place for good, so a reference does, and RAM is scarce.
/// Elsewhere whoever makes a Robot may hand in what soon is no more: there it is a copy.
#ifdef __AVR__
template <class T>
using Kept = const T&;
template <class T>
inline void keep(const T& /*kept*/, const T& /*now*/) {}
#else
template <class T>
using Kept = T;
/// What has changed at the place it was given from is taken again where it is a copy.
template <class T>
inline void keep(T& kept, const T& now) {
  kept = now;
}
#endif

}  // namespace screed
