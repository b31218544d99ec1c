// Which leveling algorithms this build has. Apart from parameters.h, so that an algorithm more is
// compiled into what knows algorithms alone.
#pragma once

#include <stdint.h>

#include "firmware/parameters/parameters.h"
#include "schema/class_values.h"

// The algorithms that this build leaves out, by their names, a space between two: make firmware
// LEAVE_OUT="coverage training_drive". Their numbers are then invalid parameters, with which a
// robot refuses to arm. Left out of a microcontroller's image are the training drive, which drives
// blindly (simulated terrain without edges tolerates that, a site does not), and for want of flash
// the one behind it.
#ifndef SCREED_LEAVE_OUT
#ifdef __AVR__
#define SCREED_LEAVE_OUT "training_drive peak_memory"
#else
#define SCREED_LEAVE_OUT ""
#endif
#endif

/// A row's text of one leveling algorithm.
#define SCREED_ALGORITHM_TEXT(number, name, Name) ", " #number " " #name

namespace screed {

/// Whether `list` begins with this word.
constexpr bool begins_with(const char* list, const char* word) {
  return *word == 0 ? *list == 0 || *list == ' '
                    : *list == *word && begins_with(list + 1, word + 1);
}
/// Whether `word` is one of the words of `list`, which begins between two words or in one.
constexpr bool lists(const char* list, const char* word, bool between = true) {
  return *list != 0 &&
         ((between && begins_with(list, word)) || lists(list + 1, word, *list == ' '));
}
constexpr uint8_t words_of(const char* list, bool between = true) {
  return *list == 0 ? static_cast<uint8_t>(0)
                    : static_cast<uint8_t>((between && *list != ' ' ? 1 : 0) +
                                           words_of(list + 1, *list == ' '));
}

/// The leveling algorithms of this build, a bit each.
#define SCREED_ALGORITHM_BIT(number, name, Name) \
  | (lists(SCREED_LEAVE_OUT, #name) ? 0U : 1U << (number))
constexpr uint16_t kAlgorithmsInBuild = 0U SCREED_LEVELING_ALGORITHM(SCREED_ALGORITHM_BIT);
#undef SCREED_ALGORITHM_BIT
#define SCREED_ANY_BIT(number, name, Name) | 1U << (number)
constexpr uint16_t kAllAlgorithms = 0U SCREED_LEVELING_ALGORITHM(SCREED_ANY_BIT);
#undef SCREED_ANY_BIT
constexpr uint8_t bits_of(uint16_t bits) {
  return bits == 0 ? static_cast<uint8_t>(0)
                   : static_cast<uint8_t>((bits & 1U) + bits_of(static_cast<uint16_t>(bits >> 1)));
}
static_assert(words_of(SCREED_LEAVE_OUT) == bits_of(kAllAlgorithms) - bits_of(kAlgorithmsInBuild),
              "LEAVE_OUT names algorithms");
static_assert(message::kLevelingAlgorithmMax < 16, "kAlgorithmsInBuild has 16 bits");

constexpr bool algorithm_in_build(int16_t number) {
  return (kAlgorithmsInBuild >> number & 1) != 0;
}

/// The greatest number of an algorithm of this build.
constexpr int16_t max_algorithm(int16_t from) {
  return algorithm_in_build(from) ? from : max_algorithm(static_cast<int16_t>(from - 1));
}
constexpr int16_t kMaxAlgorithm = max_algorithm(message::kLevelingAlgorithmMax);
static_assert(algorithm_in_build(kDefaultAlgorithm), "the default algorithm is in every build");
#ifndef SCREED_DEFAULT_ALGORITHM
static_assert(kDefaultAlgorithm == static_cast<int16_t>(message::LevelingAlgorithm::kHillSensing),
              "the default algorithm is that of the thesis");
#endif

}  // namespace screed
