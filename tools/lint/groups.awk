# Which sources one run of clang-tidy may look at together: prints groups, one a line. Input: a line a source, "CLASS SOURCE
# DEPENDENCIES", where sources of one class share compiler flags and DEPENDENCIES is the compiler's list of what the source includes.
#
# Most of a run goes into the headers of the libraries, so the more share it the better; but a source must be seen as if it were alone.
# Not together are therefore
#   sources that give names of their own (in anonymous namespaces, static, as macros; main) the same name, or one that a header of
#     ours gives which another of them includes,
#   tests that know a namespace `testing` of ours and tests that mean gtest's by that name,
#   sources of which one includes the header of the other: the analyser would follow calls from one into the other, and then not
#     look at the function that is called with arguments nobody knows,
#   a source that declares what others define (the list of subcommands),
#   a source whose alias or using-declaration it does not use itself (another one might), or that includes a header twice.
BEGIN { most = most ? most : 30 }

function note(name) { if (name != "") own[source, ++names[source]] = name }

# The name that a line declares.
function declared(line) {
  sub(/[(={;[].*/, "", line)
  sub(/ : .*/, "", line)  # base classes
  sub(/ +(final)? *$/, "", line)
  sub(/.*[^A-Za-z_0-9]/, "", line)
  return line
}

# What a header declares at its left margin, and its macros: "name name ...".
function read_header(file,    line, names) {
  names = ""
  while ((getline line < file) > 0) {
    if (line ~ /^namespace [a-z_:]*testing \{/) opens_testing[file] = 1
    if (sub(/^# *define +/, "", line)) { sub(/[^A-Za-z0-9_].*/, "", line); names = names " " line; continue }
    if (line ~ /^[A-Za-z_]/ && line !~ /^(namespace|template|static_assert|using namespace)[^A-Za-z_0-9]/) names = names " " declared(line)
  }
  close(file)
  return names
}

# Names at the left margin of anonymous namespaces; clang-format keeps them there.
function read_source(    line, inside, alias, aliases, included, parts, count, i) {
  inside = 0
  split("", aliases)
  split("", included)
  alone[source] = 0
  while ((getline line < source) > 0) {
    if (line ~ /^#include / && included[line]++) alone[source] = 1
    if (line ~ /^#include "commands.h"/) alone[source] = 1
    # Code for several instruction sets, inside the namespace where it is included.
    if (line ~ /^#include ".*\.inc"/) {
      split(line, parts, "\"")
      count = split(read_header(parts[2]), parts, " ")
      for (i = 1; i <= count; ++i) note(parts[i])
    }
    if (line ~ /^int main\(/) note("main")
    for (alias in aliases) if (line ~ ("(^|[^A-Za-z_0-9])" alias "([^A-Za-z_0-9]|$)")) delete aliases[alias]
    if (line ~ /^ *(namespace [a-z_0-9]+ = |using [A-Za-z_0-9]+::)/) {
      alias = line
      if (sub(/^ *namespace /, "", alias)) sub(/ = .*/, "", alias)
      else { sub(/;.*/, "", alias); sub(/.*::/, "", alias) }
      aliases[alias] = 1
    }
    if (line ~ /^namespace [a-z_:]*testing \{/) testing[source] = "ours"
    else if (line ~ /(^|[^:a-z_])testing::/ && !testing[source]) testing[source] = "gtest"
    if (line ~ /^namespace \{/) { inside = 1; continue }
    if (line ~ /^\}  \/\/ namespace$/) { inside = 0; continue }
    if (line ~ /^# *define /) { sub(/^# *define +/, "", line); sub(/[^A-Za-z0-9_].*/, "", line); note(line); continue }
    if (line ~ /^static /) sub(/^static /, "", line)
    else if (!inside) continue
    if (line !~ /^[A-Za-z_]/) continue
    if (line ~ /^(namespace|template|static_assert|TEST|TEST_[FP]|TYPED_TEST|INSTANTIATE_[A-Z_]+|BENCHMARK|BENCHMARK_[A-Z_]+)[^A-Za-z_0-9]/) continue
    note(declared(line))
  }
  close(source)
  for (alias in aliases) alone[source] = 1
}

function read_dependencies(file,    line, parts, part, count, key, i) {
  split("", includes)
  while ((getline line < file) > 0) {
    count = split(line, parts, /[ \\:]+/)
    for (i = 1; i <= count; ++i) if (parts[i] ~ /^[^\/].*\.h$/) includes[source, parts[i]] = 1
  }
  close(file)
  # The names of all headers it includes.
  split("", shared)
  for (key in includes) {
    split(key, part, SUBSEP)
    if (part[1] != source) continue
    if (!(part[2] in header_names)) header_names[part[2]] = read_header(part[2])
    if (part[2] in opens_testing) testing[source] = "ours"
    count = split(header_names[part[2]], parts, " ")
    for (i = 1; i <= count; ++i) shared[parts[i]] = 1
  }
}

function header(of) { sub(/\.cpp$/, ".h", of); return of }

function fits(group,    name, i) {
  if (class[group] != $1 || $1 == "avr" || size[group] >= most || alone[source] || alone[member[group, 1]]) return 0
  if (testing[source] && testing_of[group] && testing[source] != testing_of[group]) return 0
  for (i = 1; i <= names[source]; ++i) if ((group, own[source, i]) in taken || (group, own[source, i]) in given) return 0
  for (name in shared) if ((group, name) in taken) return 0
  if ((group, header(source)) in known) return 0
  for (i = 1; i <= size[group]; ++i) if ((source, header(member[group, i])) in includes) return 0
  return 1
}

{
  source = $2
  names[source] = 0
  read_source()
  read_dependencies($3)
  for (group = 1; group <= groups; ++group) if (fits(group)) break
  if (group > groups) { groups = group; class[group] = $1 }
  member[group, ++size[group]] = source
  if (testing[source]) testing_of[group] = testing[source]
  for (i = 1; i <= names[source]; ++i) taken[group, own[source, i]] = 1
  for (name in shared) given[group, name] = 1
  for (key in includes) {
    split(key, part, SUBSEP)
    if (part[2] !~ /^\//) known[group, part[2]] = 1
  }
}

END {
  for (group = 1; group <= groups; ++group) {
    line = class[group]
    for (i = 1; i <= size[group]; ++i) line = line " " member[group, i]
    print line
  }
}
