#!/bin/sh
# Points as files: what is read, and the one line about what is not. tests/cli/points.c has the details.
. tests/cli/support/check.sh

# bad NAME TEXT MESSAGE [ARGUMENT...]: the file TEXT (printf escapes) fails with FILE:MESSAGE, for every command.
bad() {
    name=$1
    message=$3
    printf -- "$2" >"$dir/points.txt"
    shift 3
    for command in aim hull; do
        run $command "$@" "$dir/points.txt"
        ends "$command: $name" 2 "$dir/points.txt:$message"
    done
}
bad 'letters in a number' '1 0 0\n1 0x 0\n' "2: '0x' is not a decimal number"
bad 'hexadecimal' '0x1p3 0 0\n' "1: '0x1p3' is not a decimal number"
bad 'NaN' '1 0 0\n\n# c\nnan 1 1\n' "4: 'nan' is not a decimal number"
bad 'infinity' '1 0 -inf\n' "1: '-inf' is not a decimal number"
bad 'a header line' 'x,y,z\n1,2,3\n' "1: 'x' is not a decimal number"
bad 'too few columns' '1 2\n' '1: 2 columns, not 3 (x y z)'
bad 'too many columns' '1 2 3 4\n' '1: 4 columns, not 3 (x y z)'
bad 'a comma too many' '1,2,,3\n' '1: an empty column: a comma without a value beside it'
bad 'a number beyond all bounds' '1 2 1e401\n' "1: '1e401' has digits above 10^400 or below 10^-1100"
bad 'a point at the origin' '1 2 3\n0 -0 0.0\n' '2: the point is at the viewpoint: it has no direction'
bad 'a point at the viewpoint' '1.50 -2 3e-1\n' '1: the point is at the viewpoint: it has no direction' \
    --viewpoint 1.5,-2,0.3
bad 'q30 beyond int32' '1 2 2147483648\n' "1: '2147483648' does not fit int32 (-2147483648 to 2147483647)" --input q30
bad 'q30 with a fraction' '1 2 3.5\n' "1: '3.5' is not an integer" --input q30
bad 'q30 zero' '0 0 0\n' '1: the zero vector has no direction' --input q30
bad 'a declination beyond the pole' '10 20\n10 -90.000001\n' "2: declination '-90.000001' is beyond 90 degrees" \
    --input radec
bad 'three columns for radec' '10 20 30\n' '1: 3 columns, not 2 (right ascension, declination)' --input radec
bad 'no name' '1 2 3\n' '1: 3 columns, not 4 (name x y z)' --named
bad 'a name too many' 'nose 1 2 3\n' '1: 4 columns, not 3 (x y z)'
bad 'a NUL byte' '1 2 3\n1 \0002 3\n' '2: a NUL byte: this is no text file'
bad 'a line without end' "$(awk 'BEGIN { for (i = 0; i < 9000; i++) printf "1" }')\\n" \
    '1: the line is longer than 8191 bytes'

printf '1 2\n' >"$dir/two.txt"
run aim <"$dir/two.txt"
ends 'a fault on stdin' 2 'stdin:1: 2 columns, not 3 (x y z)'
run aim --json <"$dir/two.txt"
ends 'a fault with --json: no half object' 2 'stdin:1: 2 columns, not 3 (x y z)'

# aims NAME TEXT FACT...: the points point along +y, whatever they are written like.
aims() {
    name=$1
    printf -- "$2" >"$dir/points.txt"
    shift 2
    run aim --json "$@" "$dir/points.txt"
    has "$name" 0 'ahead_q30[0]=0' 'ahead_q30[1]=1073741824' 'ahead_q30[2]=0'
}
aims 'blanks' '-1 2 0\n1   2 0\n'
aims 'tabs and commas' '-1\t2,0\n1, 2 ,0\n'
aims 'CR LF' '-1 2 0\r\n1 2 0\r\n'
aims 'no end of the last line' '-1 2 0\n1 2 0'
aims 'a byte order mark' '\357\273\277-1 2 0\n1 2 0\n'
aims 'comments and blank lines' '# c\n\n-1 2 0# c\n \t\n1 2 0 # c\n'
aims 'exponents, signs and zeros' '-1e0 +2. -0\n.1e1 200e-2 0e9\n'
aims 'tiny numbers' '-1e-300 2e-300 0\n1e-300 2e-300 0\n'
aims 'huge numbers' '-1e300 2e300 0\n1e300 2e300 0\n'
aims 'tiny and huge numbers in one point' '1e-300 1e300 0\n'
aims 'points at very different distances' '1.5 1e-30 0.1\n1.5 1e30 0.1\n' --viewpoint 1.5,0,0.1
aims 'names' 'nose -1 2 0\n7 1 2 0\n' --named
aims 'radec' '85 0\n455.0 0\n' --input radec
aims 'a viewpoint far away' '1234567890.1 -9876543210.123456789 3\n' \
    --viewpoint 1234567890.1,-9876543210.123456790,3.0

# Thirty digits are not cut: the two points are apart in the last one only, and the viewpoint between them.
printf '0.100000000000000000000000000001 0 0\n0.100000000000000000000000000003 0 0\n' >"$dir/points.txt"
run aim --json --viewpoint 0.100000000000000000000000000002,0,0 "$dir/points.txt"
has 'antipodal in the thirtieth digit' 3 'feasible=false' 'witness[0]=0' 'witness[1]=1'
# 0.1 + 0.2 = 0.3 holds for decimals, so these three are on one great circle through the viewpoint, and closed.
printf '0.3 0 0\n-0.1 0.2 0\n-0.1 -0.2 0\n' >"$dir/points.txt"
run aim --json "$dir/points.txt"
has 'exactly coplanar decimals' 3 'feasible=false'
printf '0.3 0 0.000000001\n-0.1 0.2 0\n-0.1 -0.2 0\n' >"$dir/points.txt"
run aim --json "$dir/points.txt"
has 'and not quite so' 0 'feasible=true'

# Opposite stars are opposite to the last bit.
printf '10.1 20.2\n190.1 -20.2\n' >"$dir/points.txt"
run aim --json --input radec "$dir/points.txt"
has 'antipodal stars' 3 'feasible=false' 'witness[0]=0' 'witness[1]=1'

# Half a million lines, names and comments among them.
awk 'BEGIN {
    for (i = 0; i < 500000; i++)
        printf "p%d %d.%03d 1000 %d # %d\n", i, i % 777 - 388, i % 1000, i % 555 - 277, i
}' >"$dir/big.txt"
run aim --named --json "$dir/big.txt"
has 'half a million points' 0 'feasible=true' 'count=500000'
awk 'NR == 400000 { print "p 1 2" } { print }' "$dir/big.txt" >"$dir/points.txt"
run aim --named --json "$dir/points.txt"
ends 'a fault far into the file' 2 "$dir/points.txt:400000: 3 columns, not 4 (name x y z)"

finish
