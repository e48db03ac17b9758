#!/bin/sh
# `sim`, `run` and `config check` from outside: results, bad input, exit statuses.
. tests/cli/support/check.sh
scenarios=host-sim/scenarios

# One seed, the same bits: twice, and with every compiler.
hash_of() { # PROGRAM SCENARIO [OPTION...]
    program=$1
    scenario=$2
    shift 2
    "$program" sim "$scenarios/$scenario.ini" --json "$@" | sed 's/.*"trace_hash": "\([0-9a-f]*\)".*/\1/'
}
for scenario in stars pedestrians moving hobby; do
    first=$(hash_of build/gcc/boresight $scenario --seconds 20)
    [ ${#first} -eq 16 ] && [ "$first" = "$(hash_of build/gcc/boresight $scenario --seconds 20)" ]
    verdict "$scenario twice: the same trace hash" $?
    [ "$first" = "$(hash_of build/clang/boresight $scenario --seconds 20)" ]
    verdict "$scenario with gcc and clang: the same trace hash" $?
    [ "$first" = "$(hash_of build/san/boresight $scenario --seconds 20)" ]
    verdict "$scenario with the sanitizers: the same trace hash" $?
done
[ "$(hash_of build/gcc/boresight moving --seconds 5 --seed 2)" != "$(hash_of build/gcc/boresight moving --seconds 5 --seed 3)" ]
verdict 'another seed, another trace hash' $?

run sim $scenarios/stars.ini --json --report "$dir/report"
has 'sim --json' 0 'seconds=61.000' 'steps=61000' 'violations=0' 'faults_injected=0' 'mode="tracking"'
[ -s "$dir/report/report.html" ] && ! grep -qE 'src="?https?:|href="?https?:' "$dir/report/report.html"
verdict 'sim --report writes a page that needs no other host' $?
run sim $scenarios/hobby.ini --seconds 2 --speed 4 --quiet
[ "$status" -eq 0 ]
verdict 'sim --speed' $?

# The results of a run that also told its modes on stderr.
gives() { # NAME STATUS PATH=VALUE...
    cp "$dir/err" "$dir/told"
    : >"$dir/err"
    has "$@"
    cp "$dir/told" "$dir/err"
}

# ---------------------------------------------------------------- bad input, each one line, status 2
refuse 'sim without a scenario' 'which scenario' sim
refuse 'a scenario that is not there' 'nowhere.ini' sim nowhere.ini
refuse 'sim --seconds 0' '--seconds' sim $scenarios/stars.ini --seconds 0
refuse 'sim --seconds nan' '--seconds' sim $scenarios/stars.ini --seconds nan
refuse 'sim --speed -1' '--speed' sim $scenarios/stars.ini --speed -1
refuse 'an unknown option' '--warp' sim $scenarios/stars.ini --warp 9

cp -r host-sim "$dir/host-sim"
copy=$dir/host-sim
break_file() { # NAME TEXT-IN-THE-MESSAGE FILE SED-COMMAND
    cp "$copy/$3" "$dir/kept"
    sed -i "$4" "$copy/$3"
    refuse "$1" "$2" sim "$copy/scenarios/hobby.ini" --seconds 1
    cp "$dir/kept" "$copy/$3"
}
rig=rigs/hobby.ini
line() { grep -n "$1" "$copy/$2" | head -n 1 | cut -d: -f1; }
break_file 'an unknown key in a rig file' "hobby.ini:$(($(line '^drive' $rig) + 1)): " $rig '0,/^drive/s/^drive = pwm/drive = pwm\ndrives = pwm/'
break_file 'an unknown section in a rig file' 'hobby.ini:' $rig 's/\[camera\]/[kamera]/'
break_file 'letters in a number' "hobby.ini:$(line '^speed_max' $rig): " $rig '0,/^speed_max/s/^speed_max_dps.*/speed_max_dps = fast/'
break_file 'NaN in a rig file' 'hobby.ini:' $rig '0,/^accel/s/^accel_max_dps2.*/accel_max_dps2 = nan/'
break_file 'limits the wrong way round' 'limit_max_deg' $rig '0,/^limit_min/s/^limit_min_deg.*/limit_min_deg = 59/'
break_file 'a missing key' 'limit_min_deg' $rig '0,/^limit_min/{/^limit_min/d}'
break_file 'two servos on one channel' 'channel' $rig 's/^channel = 1/channel = 0/'
break_file 'a scenario without a rig' 'rig' scenarios/hobby.ini '/^rig/d'
break_file 'a rig that is not there' 'no-such-rig.ini' scenarios/hobby.ini 's/^rig = .*/rig = no-such-rig.ini/'
break_file 'an unknown event' "hobby.ini:" scenarios/hobby.ini 's/^do = stop/do = dance/'
break_file 'targets that are not there' 'three.jsonl' scenarios/hobby.ini 's/two.jsonl/three.jsonl/'
break_file 'a target line that is no JSON' 'two.jsonl:2: ' scenarios/two.jsonl '2s/.*/{"id": 2, "xyz": [1, 2/'
break_file 'a target without a number' 'two.jsonl:2: ' scenarios/two.jsonl '2s/.*/{"id": 2, "xyz": [1, "x", 3]}/'
break_file 'a target at infinity' 'two.jsonl:2: ' scenarios/two.jsonl '2s/.*/{"id": 2, "xyz": [1e999, 2, 3]}/'
break_file 'time that runs backwards' 'two.jsonl:4: ' scenarios/two.jsonl '4s/10000000/1/'

# ---------------------------------------------------------------- config check
for file in host-sim/rigs/*.ini; do
    run config check "$file"
    [ "$status" -eq 0 ] && grep -q 'limit_min_deg' "$dir/out" && grep -q 'follow_error_deg' "$dir/out"
    verdict "config check $file explains given and default values" $?
done
sed '0,/^speed_max_dps/s/^speed_max_dps.*/speed_max_dps = 0/' host-sim/rigs/studio.ini >"$dir/rig.ini"
refuse 'config check of a wrong rig' 'rig.ini:' config check "$dir/rig.ini"
refuse 'config without check' 'config check RIG.ini' config host-sim/rigs/studio.ini

# ---------------------------------------------------------------- run
printf '{"id": 1, "dir": [0.2, 1, 0.1]}\nnonsense\n{"id": 2, "dir": [0.1, 1, 0.2]}\n' >"$dir/live.jsonl"
run run host-sim/rigs/studio.ini --arm --seconds 1 --targets - --json <"$dir/live.jsonl"
gives 'run on stdin, with a bad line' 0 'mode="stopped"' 'targets=2' 'bad_lines=1' 'violations=0'
grep -q '^stdin:2: ' "$dir/err"
verdict 'run names the bad line' $?
refuse 'run without a rig' 'which rig? give its file' run
refuse 'run with the rig on stdin' 'which rig? give its file' run -
run run host-sim/rigs/studio.ini --seconds 0.3 --json
gives 'run does not arm by itself' 0 'mode="ready"'
: >"$dir/out" >"$dir/err" # or what waits for words may find the last run's
"$boresight" run host-sim/rigs/studio.ini --arm --targets "$dir/live.jsonl" --json >"$dir/out" 2>"$dir/err" &
until_true 30 grep -q tracking "$dir/err"
kill -INT $!
wait $!
status=$?
gives 'run ends well on SIGINT' 0 'mode="stopped"'
sed 's/^limit_min_deg = -175/home_deg = 150\nlimit_min_deg = 100/' host-sim/rigs/studio.ini >"$dir/far.ini"
run run "$dir/far.ini" --arm --seconds 0.3 --json
gives 'simulated axes begin at home, where 0 is beyond their limits' 0 'mode="stopped"' 'pan_deg=150.0000'
sed 's/^bus = fake/bus = can:can0/' host-sim/rigs/studio.ini >"$dir/real.ini"
run run "$dir/real.ini" --seconds 1
[ "$status" -eq 4 ] && grep -q 'can0: no such interface' "$dir/err"
verdict 'an interface that is not there: status 4' $?
finish
