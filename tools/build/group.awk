# The one source of a group: sources are included, tests pasted, each test's anonymous namespace under a name of its
# own, so that helpers of one name stay apart. The compiler speaks of the files themselves.
FILENAME !~ /^tests\// { print "#include \"" FILENAME "\""; nextfile }
FNR == 1 {
  print "#line 1 \"" FILENAME "\""
  space = FILENAME
  gsub(/[^A-Za-z0-9]/, "_", space)
}
/^namespace \{$/ { print "namespace { namespace " space " {"; next }
/^}  \/\/ namespace$/ { print "} }"; next }
{ print }
