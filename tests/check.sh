# For shell tests that source it: $(check NAME COMMAND...) counts in `passed` and `failed`, and shows what failed said.
passed=0
failed=0

check() {  # NAME COMMAND...
  local name=$1
  shift
  if said=$("$@" 2>&1); then
    passed=$((passed + 1))
  else
    failed=$((failed + 1))
    printf '%s: %s\n%s\n' failed "$name" "$said"
  fi
}
