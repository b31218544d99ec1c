# Broken relative links of Markdown pages (see check_links.sh). Anchors are made as GitHub makes them: lower case,
# punctuation left out, spaces to hyphens, -1, -2, ... behind a heading that came before.

function directory(path) { return match(path, /.*\//) ? substr(path, 1, RLENGTH - 1) : "." }

# a/b/../c -> a/c
function normal(path,    parts, count, kept, size, i, text) {
  count = split(path, parts, "/")
  size = 0
  for (i = 1; i <= count; ++i) {
    if (parts[i] == "." || parts[i] == "") continue
    if (parts[i] == ".." && size > 0 && kept[size] != "..") --size
    else kept[++size] = parts[i]
  }
  text = ""
  for (i = 1; i <= size; ++i) text = text (i > 1 ? "/" : "") kept[i]
  return text == "" ? "." : text
}

function anchor(heading) {
  gsub(/\]\([^)]*\)/, "", heading)
  heading = tolower(heading)
  gsub(/[^a-z0-9_ -]/, "", heading)
  gsub(/ /, "-", heading)
  return heading
}

function exists(path) { return system("test -e '" path "'") == 0 }

function read_anchors(page,    line, code, name) {
  if (page in is_read) return
  is_read[page] = 1
  code = 0
  while ((getline line < page) > 0) {
    if (line ~ /^ *```/) code = !code
    if (code || line !~ /^#+ /) continue
    sub(/^#+ +/, "", line)
    name = anchor(line)
    if ((page, name) in is_anchor) name = name "-" (++repeats[page, name])
    is_anchor[page, name] = 1
  }
  close(page)
}

function check(target,    page, place, at) {
  if (target ~ /^[a-z]+:/) return
  at = index(target, "#")
  place = at ? substr(target, at + 1) : ""
  page = at ? substr(target, 1, at - 1) : target
  page = page == "" ? FILENAME : normal(directory(FILENAME) "/" page)
  if (!(page in known)) known[page] = exists(page)
  if (!known[page]) { broken(target, "no such file"); return }
  if (place == "" || page !~ /\.md$/) return
  read_anchors(page)
  if (!((page, place) in is_anchor)) broken(target, "no such heading in " page)
}

function broken(target, reason) {
  print FILENAME ":" FNR ": " target ": " reason
  status = 1
}

FNR == 1 { in_code = 0 }
/^ *```/ { in_code = !in_code }
in_code { next }
{
  line = $0
  gsub(/`[^`]*`/, "", line)
  while (match(line, /\]\([^() ]+\)/)) {
    target = substr(line, RSTART + 2, RLENGTH - 3)
    line = substr(line, RSTART + RLENGTH)
    check(target)
  }
}
END { exit status }
