# Sources that clang-tidy looks at together: from words GROUP:SOURCE,SOURCE,... of tools/build/groups.awk, and SOURCE
# for one that is compiled alone, makes words OBJECT,OBJECT:SOURCE,SOURCE of up to some sixty sources; `folder` is that
# of the groups' objects.
function finish() { if (size) print objects ":" sources; size = 0; objects = sources = "" }
{
  count = 1
  object = build "/" $0
  sub(/\.cpp$/, ".o", object)
  members = $0
  if (split($0, part, ":") == 2) {
    object = folder "/" part[1] ".o"
    members = part[2]
    count = split(members, each, ",")
  }
  if (size + count > most) finish()
  objects = objects (size ? "," : "") object
  sources = sources (size ? "," : "") members
  size += count
}
BEGIN { most = 64 }
END { finish() }
