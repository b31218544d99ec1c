// Worst-case stack of an AVR image, from its instructions alone.
#include "tools/avr/stack/stack_analysis.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include "host_sim/core/errors.h"
#include "tools/avr/stack/constant_registers.h"

namespace screed::avr_stack {
namespace {

constexpr std::int32_t kReturnAddress = 2;
constexpr std::uint32_t kReset = 0;
constexpr std::uint32_t kVectorSize = 4;
// A vector that no program part claims jumps to reset, of the C library's start-up code by way of
// this.
constexpr std::string_view kUnusedVector = "__bad_interrupt";

bool is_any(std::string_view text, std::initializer_list<std::string_view> of) {
  return std::find(of.begin(), of.end(), text) != of.end();
}

bool writes_stack_pointer(const Instruction& instruction) {
  if (instruction.operands.empty()) return false;
  const std::string& first = instruction.operands.front();
  // 0x3d, 0x3e as input and output registers, 0x5d, 0x5e as memory addresses.
  return (instruction.mnemonic == "out" && is_any(first, {"0x3d", "0x3e"})) ||
         (instruction.mnemonic == "sts" &&
          is_any(first, {"0x005D", "0x005E", "0x005d", "0x005e", "0x5d", "0x5e"}));
}

/// What is known when an instruction is about to run.
struct State {
  std::int32_t height = 0;
  FramePointer y;
  ConstantRegisters constants;
  bool operator==(const State&) const = default;
};

/// The deepest point that a function reaches, its callees included.
struct Depth {
  std::int32_t bytes = 0;               ///< above the return address of the function
  std::int32_t own_bytes = 0;           ///< of these, held by the function itself
  std::optional<std::uint32_t> callee;  ///< the function called at that point
  std::uint32_t place = 0;              ///< the instruction
};

class Analysis {
 public:
  Analysis(const Disassembly& program, const IndirectCalls& indirect)
      : program_(program), indirect_(indirect) {}

  StackReport report();

 private:
  const Depth& depth_of(std::uint32_t entry);
  Depth walk(std::uint32_t entry);
  std::vector<std::uint32_t> successors(const Instruction& instruction, const State& state) const;
  /// What a call instruction calls; nothing when it is no call.
  std::vector<std::uint32_t> callees(const Instruction& instruction) const;
  std::vector<std::uint32_t> indirect_targets(const Instruction& instruction) const;
  void step(const Instruction& instruction, State& state) const;
  StackPath path(std::uint32_t entry, std::string name, std::int32_t entry_bytes);
  const Instruction& instruction_at(std::uint32_t address) const;
  [[noreturn]] void refuse(const Instruction& instruction, const std::string& why) const;

  const Disassembly& program_;
  const IndirectCalls& indirect_;
  std::map<std::uint32_t, Depth> done_;
  std::vector<std::uint32_t> active_;  // the functions being walked, outermost first
  bool in_interrupt_ = false;
  std::set<std::uint32_t> walked_in_interrupt_;
};

void Analysis::refuse(const Instruction& instruction, const std::string& why) const {
  std::string place(16, '\0');
  place.resize(static_cast<std::size_t>(
      std::snprintf(place.data(), place.size(), "0x%x", instruction.address)));
  std::string text = instruction.mnemonic;
  for (std::size_t i = 0; i < instruction.operands.size(); ++i) {
    text += (i == 0 ? " " : ", ") + instruction.operands[i];
  }
  std::string where = program_.name_of(instruction.address);
  const bool known = !active_.empty() && active_.back() != kReset;
  const std::string entry = known ? program_.name_of(active_.back()) : where;
  if (entry != where) where += ", part of " + entry;
  throw RunError("no stack bound: " + why + " at " + place + " in " + where + " (" + text + ")");
}

const Instruction& Analysis::instruction_at(std::uint32_t address) const {
  const Instruction* const found = program_.at(address);
  if (found == nullptr) {
    throw InputError("the disassembly has no instruction at the end of " +
                     program_.name_of(address) + "; expected a whole linked image");
  }
  return *found;
}

std::vector<std::uint32_t> Analysis::successors(const Instruction& instruction,
                                                const State& state) const {
  const std::string_view what = instruction.mnemonic;
  if (is_any(what, {"ret", "reti"})) return {};
  if (is_any(what, {"ijmp", "eijmp"})) {
    const auto known = state.constants.jump_target();
    return known ? std::vector{*known} : indirect_targets(instruction);
  }
  if (is_any(what, {"jmp", "rjmp"})) {
    if (!instruction.target) refuse(instruction, "jump to an unknown address");
    if (*instruction.target == kReset) return {};  // starts again with an empty stack
    return {*instruction.target};
  }
  std::vector<std::uint32_t> next = {instruction.next()};
  if (what.starts_with("br") && what != "break") {
    if (!instruction.target) refuse(instruction, "branch to an unknown address");
    next.push_back(*instruction.target);
  }
  if (is_any(what, {"cpse", "sbrc", "sbrs", "sbic", "sbis"})) {
    next.push_back(instruction_at(instruction.next()).next());
  }
  return next;
}

std::vector<std::uint32_t> Analysis::indirect_targets(const Instruction& instruction) const {
  const auto listed = indirect_.find(program_.plain_name_of(instruction.address));
  if (listed == indirect_.end()) refuse(instruction, "indirect call or jump");
  std::vector<std::uint32_t> result;
  for (const std::string& target : listed->second) {
    const auto found = program_.find(target);
    if (found.empty()) {
      throw InputError("indirect calls: " + listed->first + " -> " + target +
                       ": there is no such function in the image");
    }
    result.insert(result.end(), found.begin(), found.end());
  }
  return result;
}

std::vector<std::uint32_t> Analysis::callees(const Instruction& instruction) const {
  const std::string_view what = instruction.mnemonic;
  if (is_any(what, {"icall", "eicall"})) return indirect_targets(instruction);
  if (!is_any(what, {"call", "rcall"}) || instruction.target == instruction.next()) return {};
  if (!instruction.target) refuse(instruction, "call of an unknown address");
  return {*instruction.target};
}

void Analysis::step(const Instruction& instruction, State& state) const {
  const std::string_view what = instruction.mnemonic;
  if (what == "push") {
    ++state.height;
  } else if (what == "pop") {
    if (--state.height < 0) refuse(instruction, "more popped than pushed");
  } else if (what == "rcall" && instruction.target == instruction.next()) {
    state.height += kReturnAddress;  // makes room for two bytes
  } else if (writes_stack_pointer(instruction)) {
    const auto height = state.y.as_height();
    const bool from_y = instruction.mnemonic == "out" && instruction.operands.size() == 2 &&
                        is_any(instruction.operands[1], {"r28", "r29"});
    if (!from_y || !height || *height < 0) {
      refuse(instruction, "stack pointer set to an unknown value");
    }
    // The high byte is written first; the low byte completes the change.
    if (instruction.operands[0] == "0x3d") state.height = *height;
  } else if (is_any(what, {"ret", "reti"}) && state.height != 0) {
    refuse(instruction, "return with " + std::to_string(state.height) + " bytes on the stack");
  }
  state.y.step(instruction, state.height, state.constants);
  state.constants.step(instruction);
}

Depth Analysis::walk(std::uint32_t entry) {
  Depth deepest;
  deepest.place = entry;
  std::map<std::uint32_t, State> before = {{entry, State{}}};
  std::vector<std::uint32_t> open = {entry};
  while (!open.empty()) {
    const Instruction& instruction = instruction_at(open.back());
    open.pop_back();
    State state = before.at(instruction.address);
    if (in_interrupt_ && instruction.mnemonic == "sei") {
      refuse(instruction, "an interrupt that lets others interrupt it");
    }

    if (state.height > deepest.bytes) {
      deepest = {state.height, state.height, std::nullopt, instruction.address};
    }
    for (const std::uint32_t callee : callees(instruction)) {
      if (std::find(active_.begin(), active_.end(), callee) != active_.end()) {
        refuse(instruction, "recursion into " + program_.name_of(callee));
      }
      const std::int32_t bytes = state.height + kReturnAddress + depth_of(callee).bytes;
      if (bytes > deepest.bytes) deepest = {bytes, state.height, callee, instruction.address};
    }

    step(instruction, state);
    if (state.height > deepest.bytes) {
      deepest = {state.height, state.height, std::nullopt, instruction.address};
    }
    for (const std::uint32_t next : successors(instruction, state)) {
      const auto [known, is_new] = before.emplace(next, state);
      if (is_new) {
        open.push_back(next);
        continue;
      }
      if (known->second.height != state.height) {
        refuse(instruction_at(next), "stack height differs between two paths");
      }
      const State both = {state.height, FramePointer::meet(known->second.y, state.y),
                          ConstantRegisters::meet(known->second.constants, state.constants)};
      if (!(both == known->second)) {
        known->second = both;
        open.push_back(next);
      }
    }
  }
  return deepest;
}

const Depth& Analysis::depth_of(std::uint32_t entry) {
  // What was walked for the main program is walked again for an interrupt: it must not enable them.
  const bool again = in_interrupt_ && walked_in_interrupt_.insert(entry).second;
  const auto known = done_.find(entry);
  if (known != done_.end() && !again) return known->second;
  active_.push_back(entry);
  const Depth depth = walk(entry);
  active_.pop_back();
  return done_.insert_or_assign(entry, depth).first->second;
}

StackPath Analysis::path(std::uint32_t entry, std::string name, std::int32_t entry_bytes) {
  StackPath result;
  result.entry = std::move(name);
  std::int32_t return_address = entry_bytes;
  std::optional<std::uint32_t> at = entry;
  while (at) {
    const Depth depth = depth_of(*at);
    std::string frame_name = program_.name_of(*at);
    const std::string deepest_name = program_.name_of(depth.place);
    if (deepest_name != frame_name) frame_name += " => " + deepest_name;
    const auto bytes = static_cast<std::uint32_t>(return_address + depth.own_bytes);
    result.frames.push_back({std::move(frame_name), bytes});
    result.bytes += bytes;
    return_address = kReturnAddress;
    at = depth.callee;
  }
  return result;
}

StackReport Analysis::report() {
  const auto vectors = program_.range_of("__vectors");
  if (!vectors || vectors->begin != kReset) {
    throw InputError("no vector table __vectors at address 0; expected a whole linked image");
  }
  StackReport result;
  result.main = path(kReset, "reset", 0);

  in_interrupt_ = true;
  for (std::uint32_t at = vectors->begin + kVectorSize; at < vectors->end; at += kVectorSize) {
    const auto target = instruction_at(at).target;
    if (!target || *target == kReset || program_.name_of(*target) == kUnusedVector) continue;
    result.interrupts.push_back(path(*target, program_.name_of(*target), kReturnAddress));
  }
  std::stable_sort(result.interrupts.begin(), result.interrupts.end(),
                   [](const StackPath& a, const StackPath& b) { return a.bytes > b.bytes; });
  return result;
}

}  // namespace

StackReport analyze(const Disassembly& program, const IndirectCalls& indirect) {
  return Analysis(program, indirect).report();
}

}  // namespace screed::avr_stack
