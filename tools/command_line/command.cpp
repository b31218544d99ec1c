// Registration of options and subcommands.
#include "tools/command_line/command.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace screed {
namespace {

bool is_long(const std::string& name) {
  return name.rfind("--", 0) == 0;
}

/// What a target holds, as text; empty: nothing that could be a default.
struct ValueText {
  std::string operator()(const std::string* value) const { return *value; }
  std::string operator()(const std::filesystem::path* value) const { return value->string(); }
  std::string operator()(const std::optional<std::string>* value) const {
    return value->value_or("");
  }
  template <class Number>
  std::string operator()(const std::optional<Number>* value) const {
    return value->has_value() ? (*this)(&value->value()) : "";
  }
  template <class Element>
  std::string operator()(const std::vector<Element>* values) const {
    std::string text;
    for (const Element& value : *values) text += (text.empty() ? "" : ",") + (*this)(&value);
    return text;
  }
  template <class Number>
  std::string operator()(const Number* number) const {
    std::ostringstream text;
    text << *number;
    return text.str();
  }
  std::string operator()(const Option::Reader&) const { return ""; }
  std::string operator()(const Option::ShowHelp&) const { return ""; }
  std::string operator()(const Option::ShowVersion&) const { return ""; }
};

}  // namespace

Option::Option(const std::string& names, Target target, const std::string& help) {
  spec_.written = names;
  spec_.target = std::move(target);
  spec_.help = help;
  std::istringstream words(names);
  for (std::string word; std::getline(words, word, ',');)
    spec_.names.push_back(word.substr(word.find_first_not_of('!')));
  std::stable_partition(spec_.names.begin(), spec_.names.end(),
                        [](const std::string& name) { return !is_long(name); });
}

Option* Option::required() {
  spec_.required = true;
  return this;
}

Option* Option::type_name(const std::string& word) {
  spec_.type = word;
  return this;
}

Option* Option::help_text(const std::string& text) {
  spec_.help = text;
  return this;
}

Option* Option::show_default() {
  if (std::holds_alternative<Reader>(spec_.target)) return this;  // it has no value to show
  return show_default(std::visit(ValueText{}, spec_.target));
}

Option* Option::show_default(const std::string& text) {
  spec_.fallback = text;
  return this;
}

Option* Option::group(const std::string& heading) {
  spec_.group = heading;
  return this;
}

Option* Option::one_of(const std::vector<std::string>& choices) {
  spec_.choices = choices;
  return this;
}

Option* Option::suggest(const std::vector<std::string>& words) {
  spec_.takes_others = true;
  return one_of(words);
}

Option* Option::range(int low, int high) {
  spec_.range = {static_cast<double>(low), static_cast<double>(high), true};
  return this;
}

Option* Option::range(double low, double high) {
  spec_.range = {low, high, false};
  return this;
}

Option* Option::positive() {
  spec_.positive = true;
  return this;
}

Option* Option::expected(int least, int most) {
  spec_.values = {least, most};
  return this;
}

Option* Option::one_value_each() {
  spec_.one_each = true;
  return this;
}

Option* Option::delimiter(char between) {
  spec_.delimiter = between;
  return this;
}

Option* Option::needs(const Option* other) {
  spec_.needs.push_back(other);
  return this;
}

Option* Option::excludes(Option* other) {
  spec_.excludes.push_back(other);
  other->spec_.excludes.push_back(this);
  return this;
}

std::string Option::name() const {
  const auto first_long = std::find_if(spec_.names.begin(), spec_.names.end(), is_long);
  return first_long == spec_.names.end() ? spec_.names.front() : *first_long;
}

bool Option::is_argument() const {
  return spec_.names.front().front() != '-';
}

bool Option::is_flag() const {
  return std::holds_alternative<bool*>(spec_.target) ||
         std::holds_alternative<ShowHelp>(spec_.target) ||
         std::holds_alternative<ShowVersion>(spec_.target);
}

bool Option::is_repeated() const {
  if (spec_.values.has_value()) return spec_.values->second < 0;
  return std::holds_alternative<std::vector<std::string>*>(spec_.target) ||
         std::holds_alternative<std::vector<int>*>(spec_.target);
}

Command::Command(const std::string& help, const std::string& name) : name_(name), help_(help) {
  add("-h,--help", Option::ShowHelp{}, "Print this help message and exit");
}

Option* Command::add(const std::string& names, Option::Target target, const std::string& help) {
  return options_.emplace_back(std::make_unique<Option>(names, std::move(target), help)).get();
}

Command* Command::add_subcommand(const std::string& name, const std::string& help) {
  Command* below = subcommands_.emplace_back(std::make_unique<Command>(help, name)).get();
  below->parent_ = this;
  below->falls_through_ = falls_through_;
  below->options_.front()->help_text(options_.front()->spec().help);
  return below;
}

Command* Command::callback(std::function<void()> function) {
  callback_ = std::move(function);
  return this;
}

Command* Command::fallthrough() {
  falls_through_ = true;
  return this;
}

void Command::set_version_flag(const std::string& names, const std::string& text,
                               const std::string& help) {
  add(names, Option::ShowVersion{text}, help);
}

std::string Command::path() const {
  return parent_ == nullptr ? name_ : parent_->path() + " " + name_;
}

Option* Command::option(const std::string& name) const {
  for (const std::unique_ptr<Option>& option : options_) {
    const std::vector<std::string>& names = option->spec().names;
    if (std::find(names.begin(), names.end(), name) != names.end()) return option.get();
  }
  throw std::logic_error(name_ + " has no option " + name);
}

Command* Command::subcommand(const std::string& name) const {
  for (const std::unique_ptr<Command>& below : subcommands_)
    if (below->name() == name) return below.get();
  return nullptr;
}

}  // namespace screed
