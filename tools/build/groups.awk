# Which sources are compiled together: from paths, sorted, a line each, makes words NAME:SOURCE,SOURCE,... A group ends with a folder,
# unless it is still small, so that a new file moves no others than its neighbours.
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
BEGIN { enough = 5; most = 8 }
END { finish() }
