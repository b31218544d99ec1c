// Names of values and flags as C++14 enumerations.
#include "tools/schema/value_code.h"

#include <algorithm>

#include "tools/schema/code_text.h"
#include "tools/schema/schema_check.h"

namespace screed::schema {
namespace {

std::string type_name(const DbcMessage& message, const Field& field) {
  return pascal_case(message.name) + pascal_case(field.name);
}

std::string comment_of(const DbcMessage& message, const Field& field, const std::string& comment) {
  return "/// " + message.name + "." + field.name + (comment.empty() ? "" : ": " + comment) + "\n";
}

/// X(number, name, Name) for every value: a table of the classes that they name.
std::string list_macro(const DbcMessage& message, const Field& field) {
  std::string text = "#define SCREED_" + message.name + "_" + capitals(field.name) + "(X)";
  for (const ValueName& value : field.signals.front()->values) {
    text += " \\\n  X(" + std::to_string(value.value) + ", " + value.name + ", " +
            pascal_case(value.name) + ")";
  }
  return text + "\n\n";
}

std::string enumeration(const DbcMessage& message, const Field& field) {
  return "enum class " + type_name(message, field) + " : " + unsigned_type(field.length);
}

std::string value_names(const DbcMessage& message, const Field& field) {
  const DbcSignal& signal = *field.signals.front();
  const std::string type = unsigned_type(field.length);
  const std::string name = type_name(message, field);
  std::string text =
      comment_of(message, field, signal.comment) + enumeration(message, field) + " {\n";
  std::int64_t max = 0;
  for (const ValueName& value : signal.values) {
    text += "  k" + pascal_case(value.name) + " = " + std::to_string(value.value) + ",\n";
    max = std::max(max, value.value);
  }
  text += "};\nconstexpr " + type + " k" + name + "Max = " + std::to_string(max) +
          ";  ///< the greatest of them\n";
  return text + "\n";
}

std::string flags(const DbcMessage& message, const Field& field) {
  std::string text = comment_of(message, field, "a bit each") + "struct " +
                     type_name(message, field) + " {\n  enum : " + unsigned_type(field.length) +
                     " {\n";
  for (const DbcSignal* flag : field.signals) {
    text += "    k" + pascal_case(flag->name) + " = 1U << " +
            std::to_string(flag->start - field.start) + ",";
    if (!flag->comment.empty()) text += "  ///< " + flag->comment;
    text += "\n";
  }
  return text + "  };\n};\n\n";
}

constexpr const char* kHead =
    "#pragma once\n\n#include <stdint.h>\n\nnamespace screed {\nnamespace message {\n\n";
constexpr const char* kTail = "}  // namespace message\n}  // namespace screed\n";

}  // namespace

std::string value_code(const Database& database) {
  std::string text = "// " + made_from(database) +
                     "\n//\n"
                     "// Of every signal with names of values an enumeration and its greatest "
                     "value, of every field\n"
                     "// of flags their bits. Values that name classes stand in class_values.h: "
                     "what does not name\n"
                     "// one of them need not be compiled anew when one is added.\n" +
                     kHead;
  for (const DbcMessage& message : database.messages) {
    for (const Field& field : fields_of(message)) {
      const DbcSignal& first = *field.signals.front();
      if (!first.flags().empty()) {
        text += flags(message, field);
      } else if (!first.class_folder().empty()) {
        text += enumeration(message, field) + ";\n\n";
      } else if (!first.values.empty()) {
        text += value_names(message, field);
      }
    }
  }
  return text + kTail;
}

std::string class_values(const Database& database) {
  std::string text = "// " + made_from(database) +
                     "\n//\n"
                     "// Of every signal whose values name classes an enumeration, its greatest "
                     "value, and a list\n"
                     "// X(number, name, Name).\n" +
                     kHead;
  for (const DbcMessage& message : database.messages) {
    for (const Field& field : fields_of(message)) {
      if (field.signals.front()->class_folder().empty()) continue;
      text += value_names(message, field) + list_macro(message, field);
    }
  }
  return text + kTail;
}

std::string class_includes(const Database& database) {
  std::string text = "// " + made_from(database) + "\n#pragma once\n";
  for (const DbcMessage& message : database.messages) {
    for (const DbcSignal& signal : message.signals) {
      if (signal.class_folder().empty()) continue;
      text += "\n// The classes of " + message.name + "." + signal.name + ".\n";
      for (const ValueName& value : signal.values) {
        text += "#include \"" + signal.class_folder() + "/" + value.name + ".h\"\n";
      }
    }
  }
  return text;
}

}  // namespace screed::schema
