// The table of keys.
#include "host_sim/run/experiment/experiment_keys.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "firmware/parameters/parameters.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/finite_number.h"
#include "host_sim/core/name_list.h"
#include "host_sim/ground_station/telemetry/schema.h"
#include "host_sim/run/experiment/robot_sections.h"

namespace screed {

// How a section of an experiment file lists its keys (ground_sections.h, vehicle_sections.h): kinds
// of keys, each with how its value is read, checked, written back and described.

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

namespace {

bool is_units(const std::string& text) {
  return text == "si" || text == "sandbox";
}

/// The leveling algorithms of the schema: numbers and names.
std::span<const ValueInfo> algorithms() {
  return find_signal("leveling.algorithm").signal->values;
}

/// Keys that stand before the first section.
void list_keys_without_section(std::vector<ExperimentKey>& keys) {
  keys.push_back({"", "output_directory_prefix", "", "a folder", "where run folders are made",
                  [](Experiment& e, const std::string& text) {
                    e.output_directory_prefix = text;
                    return !text.empty();
                  },
                  [](const Experiment& e) { return std::optional(e.output_directory_prefix); }});
  const auto not_kept = [](const Experiment&) -> std::optional<std::string> { return {}; };
  keys.push_back({"", kUnitsKey, "", "si or sandbox",
                  "sandbox: a file of the thesis' simulator, see below",
                  [](Experiment&, const std::string& text) { return is_units(text); }, not_kept});
  keys.push_back({"", kSandboxKey, "", "a folder", "not used; marks a file of units = sandbox",
                  [](Experiment&, const std::string& text) { return !text.empty(); }, not_kept});
}

template <class Section>
void list_section(std::vector<ExperimentKey>& keys, const char* name, Section Experiment::*member) {
  KeyList<Section> list(keys, name, member);
  Section::list(list);
}

/// The length of the training drive is that of the experiment, and means nothing without the drive.
bool follows_from_others(const Experiment& experiment, const ParameterInfo& info) {
  if (info.number != Parameters::k_training_block) return false;
  return experiment.experiment.algorithm == kTrainingDriveName ||
         experiment.parameters.training_block() == info.default_value;
}

void list_parameters(std::vector<ExperimentKey>& keys) {
  for (const ParameterInfo& info : kParameterTable) {
    // Said in [experiment], by its name.
    if (info.number == Parameters::k_algorithm) continue;
    const auto number = static_cast<uint8_t>(&info - kParameterTable);
    keys.push_back({"parameters", info.name, info.unit,
                    "an integer " + std::to_string(info.min) + ".." + std::to_string(info.max),
                    info.meaning + std::string(changes_while_running(number) ? "; live" : ""),
                    [info](Experiment& e, const std::string& text) {
                      int16_t value = 0;
                      if (!parse_number(text, value) || value < info.min || value > info.max)
                        return false;
                      e.parameters.values[info.number] = value;
                      return true;
                    },
                    [info](const Experiment& e) -> std::optional<std::string> {
                      if (follows_from_others(e, info)) return std::nullopt;
                      return std::to_string(e.parameters.values[info.number]);
                    }});
    keys.back().multiple_of = 1;
  }
}

std::vector<ExperimentKey> make_keys() {
  std::vector<ExperimentKey> keys;
  list_keys_without_section(keys);
  list_section(keys, "vehicle", &Experiment::vehicle);
  list_section(keys, "robots", &Experiment::robots);
  list_section(keys, "map", &Experiment::map);
  list_section(keys, "relief", &Experiment::relief);
  list_section(keys, "particles", &Experiment::particles);
  list_section(keys, "raygrid", &Experiment::raygrid);
  list_section(keys, "soil", &Experiment::soil);
  list_section(keys, "experiment", &Experiment::experiment);
  list_section(keys, "trap", &Experiment::trap);
  list_section(keys, "drive", &Experiment::drive);
  list_section(keys, "fixes", &Experiment::fixes);
  list_section(keys, "battery", &Experiment::battery);
  list_section(keys, "sensors", &Experiment::sensors);
  list_section(keys, "radio", &Experiment::radio);
  list_section(keys, "physics", &Experiment::physics);
  list_section(keys, "metrics", &Experiment::metrics);
  list_parameters(keys);
  list_section(keys, "later", &Experiment::later);
  return keys;
}

/// The keys that a section is looked for in.
const std::vector<ExperimentKey>& keys_with(const std::string& section) {
  const std::optional<size_t> robot = robot_of_section(section);
  return robot.has_value() ? robot_section_keys(*robot) : experiment_keys();
}

/// The known names most like what was written, to say what is allowed.
std::string known_names(const std::string& section) {
  std::string names;
  for (const ExperimentKey& key : keys_with(section)) {
    if (key.section == section) names += (names.empty() ? "" : ", ") + key.name;
  }
  return names;
}

std::string known_sections() {
  std::string names;
  std::string last;
  for (const ExperimentKey& key : experiment_keys()) {
    if (key.section != last && !key.section.empty())
      names += (names.empty() ? "[" : ", [") + key.section + "]";
    last = key.section;
  }
  return names + ", [" + section_of_robot(0) + "] to [" + section_of_robot(kMaxRobots - 1) + "]";
}

}  // namespace

const std::vector<ExperimentKey>& experiment_keys() {
  static const std::vector<ExperimentKey> table = make_keys();
  return table;
}

std::vector<std::string> algorithm_names() {
  return value_names("leveling.algorithm");
}

int16_t algorithm_number(const std::string& name) {
  for (const ValueInfo& known : algorithms()) {
    if (name == known.name) return static_cast<int16_t>(known.value);
  }
  throw InputError("unknown algorithm '" + name + "'");
}

namespace {

/// The sections that have a key of that name, in the words of the place where it was given.
std::string elsewhere(const std::string& name, const std::string& where) {
  std::string text;
  for (const ExperimentKey& key : experiment_keys()) {
    if (key.name != name || key.section.empty() || key.section == "later") continue;
    text += text.empty() ? "; did you mean " : " or ";
    text += where == "--set" ? key.section + "." + name : "[" + key.section + "] " + name;
  }
  return text;
}

}  // namespace

const ExperimentKey& find_experiment_key(const std::string& section, const std::string& name,
                                         const std::string& where) {
  const std::vector<ExperimentKey>& keys = keys_with(section);
  const auto key = std::find_if(keys.begin(), keys.end(), [&](const ExperimentKey& known) {
    return known.section == section && known.name == name;
  });
  if (key != keys.end()) return *key;
  if (section == "map" && name == "wrap") {
    throw InputError(where +
                     ": [map] wrap is now edges: for wrap = true write edges = wrap, for wrap = "
                     "false edges = open (or walls)");
  }
  const std::string names = known_names(section);
  if (names.empty()) {
    throw InputError(where + ": unknown section [" + section + "]; known are " + known_sections());
  }
  throw InputError(where + ": unknown key '" + name + "'" +
                   (section.empty() ? " before the first section" : " in [" + section + "]") +
                   elsewhere(name, where) + "; known are " + names);
}

}  // namespace screed
