#!/bin/sh
# RAM of one controller with its 256 targets, against its budget of 40 KiB. `make size` prints the whole table.
. tests/gate/verdict.sh
budget=40960
bytes=$(tests/gate/check/ram.sh 'struct controller')
echo "# struct controller: $bytes bytes of RAM, budget $budget"
[ -n "$bytes" ] && [ "$bytes" -gt 0 ] && [ "$bytes" -le $budget ]
verdict 'RAM of a controller' $?
exit $status
