# Files stay under 500 lines, functions under 60, lines under 100 columns. Usage: awk -f lengths.awk FILE...
function complain(line, what) { printf "%s:%d: %s\n", FILENAME, line, what; breaches++ }
function end_file() { if (last > 500) { printf "%s: %d lines, more than 500\n", file, last; breaches++ } }
FNR == 1 { end_file(); files++; start = 0 }
{ file = FILENAME; last = FNR }
length($0) > 100 { complain(FNR, "longer than 100 columns") }
# With our layout a function body opens with a line that ends in `) {` (or continues a signature) at any column and
# closes with a brace in the first one.
/^[a-zA-Z_].*[({,]$/ && !/^(struct|enum|union|typedef|static const|const|extern)[^(]*$/ && start == 0 { start = FNR }
/^}/ { if (start > 0 && FNR - start + 1 > 60) complain(start, "function of " FNR - start + 1 " lines, more than 60"); start = 0 }
/;$/ && !/^[ \t]/ { start = 0 }
END { end_file(); if (files == 0) { print "lengths: no files"; exit 1 } exit breaches > 0 }
