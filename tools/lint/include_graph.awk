# Input: layers.txt, then lines "FILE INCLUDED". Says which includes a layer does not allow; writes the edges between
# folders, once each, to the file named by `edges`.
function folder(path) { return sub(/\/[^\/]*$/, "", path) ? path : "." }
function within(path, prefix) { return path == prefix || index(path, prefix "/") == 1 }

FNR == NR {
  if (/^#/ || NF == 0) next
  sub(/:/, "", $1)
  known[$1] = 1
  for (i = 2; i <= NF; ++i) allowed[$1] = allowed[$1] " " $i
  next
}
{
  from = folder($1)
  to = folder($2)
  if (to == ".") next  # generated, or a board's own
  if (from != to && !seen[from, to]++) print from, to > edges
  row = from
  while (!(row in known) && row ~ /\//) row = folder(row)
  if (!(row in known)) { print "include graph: " $1 ": no row of tools/lint/layers.txt holds it"; bad = 1; next }
  if (within($2, row) || from == to) next
  count = split(allowed[row], prefixes, " ")
  for (i = 1; i <= count; ++i) if (within($2, prefixes[i])) next
  print "include graph: " $1 " includes " $2 ", which " row " may not (tools/lint/layers.txt)"
  bad = 1
}
END { printf "" > edges; exit bad }
