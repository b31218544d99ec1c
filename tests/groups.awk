# Which tests are compiled together: from paths of sources, sorted, a line each, makes words NAME:SOURCE,SOURCE,... A group ends with a
# folder, unless it is still small, so that a new file moves no others than its neighbours.
function finish() {
  if (size == 0) return
  print name (parts_of[name]++ ? "-" parts_of[name] : "") ":" members
  size = 0
}
{
  folder = $0
  sub(/\/[^\/]*$/, "", folder)
  if (size >= most || (folder != last && size >= enough)) finish()
  last = folder
  if (size == 0) { name = folder; gsub(/\//, "-", name); members = $0 } else members = members "," $0
  ++size
}
BEGIN { enough = 6; most = 10 }
END { finish() }
