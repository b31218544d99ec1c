// The sections [robot_0], [robot_1] and so on of an experiment file: what one of several robots has
// otherwise than [vehicle], [experiment], [drive] and [parameters] say for all.
//
// Their keys are those of the other sections, read and checked as there. Robot 0 is the robot that
// the experiment describes; its section has its place alone.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/experiment/experiment_keys.h"

namespace screed {

std::string section_of_robot(size_t robot);
/// The robot whose section this is; nothing for any other section.
std::optional<size_t> robot_of_section(const std::string& section);

/// The keys of a robot's section, of a number below kMaxRobots.
const std::vector<ExperimentKey>& robot_section_keys(size_t robot);

/// Whether a robot's section has the key that stands for this one.
bool robot_has_own(const Experiment& experiment, size_t robot, const std::string& section,
                   const std::string& key);
/// Puts what a robot's section says over what `experiment` says for all.
void apply_robot_section(Experiment& experiment, size_t robot);
/// The experiment as one of its robots has it.
Experiment experiment_of_robot(const Experiment& experiment, size_t robot);

/// As experiment_key_table(): the keys of a section [robot_N]; those of [parameters] in one line.
std::string robot_section_table();

}  // namespace screed
