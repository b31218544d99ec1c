// How a section of an experiment file lists its keys (sections/): kinds of keys, each with how its
// value is read, checked, written back and described.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "host_sim/core/name_list.h"
#include "host_sim/run/experiment/experiment_keys.h"

namespace screed {

/// Puts the keys of one section at the end of a table. A key's `field` is a member of Section, or a
/// function from Section& to a reference; of a std::optional nothing is written back while it is
/// empty.
template <class Section>
class KeyList {
 public:
  KeyList(std::vector<ExperimentKey>& keys, const char* section, Section Experiment::*member)
      : keys_(keys), section_(section), member_(member) {}

  /// A key just listed.
  class Row {
   public:
    /// Of two keys that stand for the same the later one holds: `forget` drops the other.
    Row replaces(void (*forget)(Section&)) {
      key_.set = [set = std::move(key_.set), member = member_, forget](Experiment& experiment,
                                                                       const std::string& text) {
        if (!set(experiment, text)) return false;
        forget(experiment.*member);
        return true;
      };
      return *this;
    }
    /// It is written back only where this holds.
    Row written_if(bool (*holds)(const Section&)) {
      key_.get = [get = std::move(key_.get), member = member_,
                  holds](const Experiment& experiment) -> std::optional<std::string> {
        return holds(experiment.*member) ? get(experiment) : std::nullopt;
      };
      return *this;
    }

    /// See ExperimentKey::default_written.
    Row default_not_written() {
      key_.default_written = false;
      return *this;
    }

   private:
    friend class KeyList;
    Row(ExperimentKey& key, Section Experiment::*member) : key_(key), member_(member) {}
    ExperimentKey& key_;
    Section Experiment::*member_;
  };

  template <class Field>
  Row flag(const char* name, const char* meaning, Field field) {
    return add(
        name, "", "true or false", meaning, field,
        [](bool& value, const std::string& text) {
          value = text == "true";
          return value || text == "false";
        },
        [](bool value) { return std::optional<std::string>(value ? "true" : "false"); });
  }

  template <class Field>
  Row real(const char* name, const char* unit, double min, double max, const char* meaning,
           Field field) {
    return add(
        name, unit, "a number " + shortest(min) + ".." + shortest(max), meaning, field,
        [min, max](auto& value, const std::string& text) {
          double number = 0.0;
          if (!parse_number(text, number) || !std::isfinite(number)) return false;
          if (number < min || number > max) return false;
          value = number;
          return true;
        },
        [](const std::optional<double>& value) {
          return value.has_value() ? std::optional(shortest(*value)) : std::nullopt;
        });
  }

  /// A multiple of `step`, from 0 up.
  template <class Field>
  Row integer(const char* name, const char* unit, uint64_t min, uint64_t max, const char* meaning,
              Field field, uint64_t step = 1) {
    Row row = add(
        name, unit,
        (step == 1 ? "an integer " : "a multiple of " + std::to_string(step) + ", ") +
            std::to_string(min) + ".." + std::to_string(max),
        meaning, field,
        [min, max, step](auto& value, const std::string& text) {
          uint64_t number = 0;
          if (!parse_number(text, number)) return false;
          if (number < min || number > max || number % step != 0) return false;
          value = static_cast<Integer<decltype(value)>>(number);
          return true;
        },
        [](const auto& value) {
          const std::optional<Integer<decltype(value)>> number = value;
          return number.has_value() ? std::optional(std::to_string(*number)) : std::nullopt;
        });
    keys_.back().multiple_of = step;
    return row;
  }

  /// One of these names.
  template <class Field>
  Row choice(const char* name, const std::vector<std::string>& names, const char* meaning,
             Field field) {
    return text(name, name_list(names, " or "), meaning, field, [names](const std::string& text) {
      return std::find(names.begin(), names.end(), text) != names.end();
    });
  }

  /// A text that `accepts` says true to; an empty one is not written back.
  template <class Field, class Accepts>
  Row text(const char* name, const std::string& allowed, const char* meaning, Field field,
           Accepts accepts) {
    return add(
        name, "", allowed, meaning, field,
        [accepts](std::string& value, const std::string& text) {
          if (!accepts(text)) return false;
          value = text;
          return true;
        },
        [](const std::string& value) {
          return value.empty() ? std::nullopt : std::optional(value);
        });
  }

 private:
  template <class Value>
  struct Unwrapped {
    using type = Value;
  };
  template <class Value>
  struct Unwrapped<std::optional<Value>> {
    using type = Value;
  };
  template <class Value>
  using Integer = typename Unwrapped<std::remove_cvref_t<Value>>::type;

  template <class Field, class Read, class Write>
  Row add(const char* name, const char* unit, const std::string& allowed, const char* meaning,
          Field field, Read read, Write write) {
    const auto set = [member = member_, field, read](Experiment& experiment,
                                                     const std::string& text) {
      return read(std::invoke(field, experiment.*member), text);
    };
    const auto get = [member = member_, field,
                      write](const Experiment& experiment) -> std::optional<std::string> {
      Section copy = experiment.*member;
      return write(std::invoke(field, copy));
    };
    keys_.push_back({section_, name, unit, allowed, meaning, set, get});
    return Row(keys_.back(), member_);
  }

  std::vector<ExperimentKey>& keys_;
  const char* section_;
  Section Experiment::*member_;
};

}  // namespace screed
