# One source of several tests: most of a test's time in the compiler goes into the headers, which they share. Their anonymous namespaces
# get the names of their files, so that helpers of one name stay apart; the compiler speaks of the files themselves.
FNR == 1 {
  print "#line 1 \"" FILENAME "\""
  space = FILENAME
  gsub(/[^A-Za-z0-9]/, "_", space)
}
/^namespace \{$/ { print "namespace { namespace " space " {"; next }
/^}  \/\/ namespace$/ { print "} }"; next }
{ print }
