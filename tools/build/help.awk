# Prints the entry points of makefiles: rules "target: ...  ## what it does (OPTION=...)", with lines "##   more"
# below them.
/^[a-z][a-z0-9-]*:.*  ## / {
  target = $0
  sub(/:.*/, "", target)
  text = $0
  sub(/.*  ## /, "", text)
  printf "make %-16s %s\n", target, text
}
/^##   / { sub(/^## +/, ""); printf "%-21s %s\n", "", $0 }
