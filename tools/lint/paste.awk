# One text of several sources, for clang-tidy: most of a run goes into the headers, which they share, and the analyser
# looks at no function of a file that is included. Each file is given twice, first to see which helpers' names (in
# anonymous namespaces, at the left margin, where clang-format keeps them) stand in several files: these are told apart
# by a macro. A test's namespace gets a name, as in a group (tools/build/group.awk).
function declared(line) {
  sub(/[(={;[].*/, "", line)
  sub(/ : .*/, "", line)  # base classes
  sub(/ +(final)? *$/, "", line)
  sub(/.*[^A-Za-z_0-9]/, "", line)
  return line
}
function leave() { for (name in renamed) print "#undef " name; delete renamed }

FNR == 1 {
  if (again[FILENAME]++) leave()
  inside = opened = 0
  space = FILENAME
  gsub(/[^A-Za-z0-9]/, "_", space)
}
again[FILENAME] == 1 && FILENAME ~ /^tests\/.*_test\.cpp$/ { next }
again[FILENAME] == 1 {
  if (/^namespace \{$/) inside = 1
  else if (/^}  \/\/ namespace$/) inside = 0
  else if (inside && /^[A-Za-z_]/ && !/^using [A-Za-z_0-9:]+;$/ &&
           !/^(namespace|template|static_assert|using namespace)[^A-Za-z_0-9]/ &&
           !/^(TEST|TEST_[FP]|TYPED_TEST|INSTANTIATE_[A-Z_]+|BENCHMARK[A-Z_]*)[^A-Za-z_0-9]/) {
    name = declared($0)
    if (name != "" && !((FILENAME, name) in own)) { own[FILENAME, name] = 1; ++files_with[name] }
  }
  next
}
FNR == 1 { print "#line 1 \"" FILENAME "\"" }
/^int main\(/ { sub(/main/, "main_" space) }
/^#include / && ($2 in included) && included[$2] != FILENAME { print ""; next }
/^#include / { included[$2] = FILENAME }
FILENAME ~ /^tests\/.*_test\.cpp$/ && /^namespace \{$/ { print "namespace { namespace " space " {"; next }
FILENAME ~ /^tests\/.*_test\.cpp$/ && /^}  \/\/ namespace$/ { print "} }"; next }
/^namespace / && !opened {
  opened = 1
  for (key in own) {
    split(key, part, SUBSEP)
    if (part[1] != FILENAME || files_with[part[2]] < 2) continue
    print "#define " part[2] " " part[2] "_" space
    renamed[part[2]] = 1
  }
  print "#line " FNR " \"" FILENAME "\""
}
{ print }
END { leave() }
