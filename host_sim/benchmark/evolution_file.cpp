// [evolution], [search] and [coarse] of a search for parameters.
#include "host_sim/benchmark/evolution_file.h"

#include <algorithm>
#include <iterator>
#include <optional>

#include "firmware/parameters/parameters.h"
#include "host_sim/campaign/campaign_values.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/name_list.h"
#include "host_sim/run/experiment/experiment_keys.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

constexpr const char* kKeys[] = {"suite",    "entry",     "objective",         "population",
                                 "seed",     "sigma",     "generations",       "beds",
                                 "duration", "finalists", "beds_a_generation", "verification_beds"};

class Reader {
 public:
  explicit Reader(fs::path path) { file_.path = std::move(path); }

  void take(const IniEntry& entry) {
    const std::string where = entry_place(file_.path, entry);
    if (entry.section == "evolution") {
      take_setting(entry, where);
    } else if (entry.section == "search") {
      take_parameter(entry, where);
    } else if (entry.section == "coarse") {
      take_coarse(entry, where);
    } else {
      throw InputError(where + ": unknown section; known are [evolution], [search] and [coarse]");
    }
  }

  EvolutionFile done() {
    const auto need = [this](bool there, const char* what) {
      if (!there) throw InputError(file_.path.string() + ": has no " + what);
    };
    need(!file_.entry.empty(), "[evolution] entry");
    need(!file_.beds.empty(), "[evolution] beds");
    need(!file_.verification_beds.empty(), "[evolution] verification_beds");
    need(!file_.parameters.empty(), "[search] with a parameter");
    for (const std::uint64_t bed : file_.verification_beds) {
      if (std::find(file_.beds.begin(), file_.beds.end(), bed) != file_.beds.end())
        throw InputError(file_.path.string() + ": bed " + std::to_string(bed) +
                         " is one of beds and of verification_beds; what was searched on verifies "
                         "nothing");
    }
    if (file_.beds_a_generation > file_.beds.size())
      throw InputError(file_.path.string() + ": beds_a_generation: there are only " +
                       std::to_string(file_.beds.size()) + " beds");
    return std::move(file_);
  }

 private:
  [[noreturn]] static void refuse(const IniEntry& entry, const std::string& where,
                                  const std::string& allowed) {
    throw InputError(where + " = '" + entry.value + "' is not allowed; expected " + allowed);
  }

  template <class Number>
  static void take_number(const IniEntry& entry, const std::string& where, double low, double high,
                          Number& number) {
    if (!parse_number(entry.value, number) || !(static_cast<double>(number) >= low) ||
        !(static_cast<double>(number) <= high)) {
      refuse(entry, where, "a number from " + shortest(low) + " to " + shortest(high));
    }
  }

  void take_setting(const IniEntry& entry, const std::string& where) {
    if (entry.key == "suite") {
      file_.suite = entry.value;
    } else if (entry.key == "entry") {
      file_.entry = entry.value;
    } else if (entry.key == "objective") {
      if (entry.value == "relief") {
        file_.objective = EvolutionObjective::kRelief;
      } else if (entry.value == "progress") {
        file_.objective = EvolutionObjective::kProgress;
      } else {
        refuse(entry, where, "relief or progress");
      }
    } else if (entry.key == "population") {
      take_number(entry, where, 5, 1000, file_.population);
    } else if (entry.key == "generations") {
      take_number(entry, where, 1, 10000, file_.generations);
    } else if (entry.key == "sigma") {
      take_number(entry, where, 0.001, 1, file_.sigma);
    } else if (entry.key == "seed") {
      take_number(entry, where, 0, 4294967295.0, file_.seed);
    } else if (entry.key == "beds") {
      file_.beds = parse_seeds(entry.value, where);
    } else if (entry.key == "beds_a_generation") {
      take_number(entry, where, 1, 1000, file_.beds_a_generation);
    } else if (entry.key == "duration") {
      take_number(entry, where, 0.01, 1e6, file_.duration_s);
    } else if (entry.key == "finalists") {
      take_number(entry, where, 1, 100, file_.finalists);
    } else if (entry.key == "verification_beds") {
      file_.verification_beds = parse_seeds(entry.value, where);
    } else {
      throw InputError(where + ": unknown key; known are " +
                       name_list(std::vector<std::string>(std::begin(kKeys), std::end(kKeys))));
    }
  }

  /// "100..300": within the parameter's own range; or "100..300 from 150".
  void take_parameter(const IniEntry& entry, const std::string& where) {
    const auto* const info =
        std::find_if(std::begin(kParameterTable), std::end(kParameterTable),
                     [&](const ParameterInfo& known) { return entry.key == known.name; });
    if (info == std::end(kParameterTable))
      throw InputError(where + ": is no parameter of the robot (screed sim --keys lists them)");
    SearchedParameter parameter{entry.key, 0, 0, info->default_value};
    std::string range = entry.value;
    const std::size_t from = range.find(" from ");
    const bool has_start = from != std::string::npos;
    const std::string start = has_start ? range.substr(from + 6) : "";
    if (has_start) range.resize(from);
    const std::size_t dots = range.find("..");
    const bool read = dots != std::string::npos &&
                      parse_number(range.substr(0, dots), parameter.low) &&
                      parse_number(range.substr(dots + 2), parameter.high) &&
                      (!has_start || parse_number(start, parameter.start));
    if (!read || parameter.low < info->min || parameter.high > info->max ||
        parameter.low >= parameter.high) {
      refuse(entry, where,
             "LOW..HIGH or LOW..HIGH from START, within " + std::to_string(info->min) + " to " +
                 std::to_string(info->max));
    }
    if (parameter.start < parameter.low || parameter.start > parameter.high)
      throw InputError(where + ": begins at " + std::to_string(parameter.start) +
                       ", which is not in the range; expected another range, or one with from");
    file_.parameters.push_back(parameter);
  }

  void take_coarse(const IniEntry& entry, const std::string& where) {
    const std::size_t dot = entry.key.find('.');
    if (dot == std::string::npos)
      throw InputError(where + ": expected section.key of an experiment file");
    find_experiment_key(entry.key.substr(0, dot), entry.key.substr(dot + 1), where);
    file_.coarse.push_back(entry);
  }

  EvolutionFile file_;
};

}  // namespace

EvolutionFile read_evolution_file(const fs::path& path) {
  Reader reader(path);
  for (const IniEntry& entry : read_ini_file(path)) reader.take(entry);
  return reader.done();
}

EvolutionFile read_evolution_text(const std::string& text, const fs::path& name) {
  Reader reader(name);
  for (const IniEntry& entry : read_ini_text(text, name.string())) reader.take(entry);
  return reader.done();
}

}  // namespace screed
