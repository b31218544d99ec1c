# Input: a line a source, "SOURCE FLAGS_FILE". Output: compile_commands.json, with the flags written out.
BEGIN { printf "[" }
{
  if (!($2 in flags)) while ((getline line < $2) > 0) {
    gsub(/--param=[^ ]* /, "", line)  # of GCC alone
    flags[$2] = flags[$2] " " line
  }
  printf "%s\n  {\"directory\": \"%s\", \"file\": \"%s\", \"command\": \"%s%s %s -c %s\"}", \
    separator, folder, $1, cxx, flags[$2], $2 ~ /host/ ? extra : "", $1
  separator = ","
}
END { print "\n]" }
