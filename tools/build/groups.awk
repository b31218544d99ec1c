# Which sources are compiled together: from paths, sorted, a line each, makes words NAME:SOURCE,SOURCE,... A group ends
# with a folder, unless it is still small (of less than two thirds of `most` sources), so that a new file moves no
# others than its neighbours. `only` names the sources that are wanted, if not all: no sources meet that do not meet in
# a group of all.
function wanted(members,    each, count, i, left) {
  if (only == "") return members
  count = split(members, each, ",")
  for (i = 1; i <= count; ++i)
    if (index(" " only " ", " " each[i] " ")) left = left (left == "" ? "" : ",") each[i]
  return left
}
function finish() {
  if (size == 0) return
  size = 0
  members = wanted(members)
  if (members == "") return
  print name (parts_of[name]++ ? "-" parts_of[name] : "") ":" members
}
{
  folder = $0
  sub(/\/[^\/]*$/, "", folder)
  if (size >= most || (folder != last && size >= enough)) finish()
  last = folder
  if (size == 0) { name = folder; gsub(/\//, "-", name); members = $0 } else members = members "," $0
  ++size
}
BEGIN { enough = int(most * 2 / 3) }
END { finish() }
