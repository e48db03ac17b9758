#!/bin/sh
# Obstacles in a scenario: what `boresight sim` says of them, and what is bad input. tests/scenario/test_obstacle.c has the aim.
. tests/cli/support/check.sh

scenario() { # SECONDS; more sections on stdin
    printf '[scenario]\nname = x\nrig = %s/host-sim/rigs/moving.ini\nseconds = %s\n[mover ann]\nid = 1\nstart_m = 0, 20, 0\n' "$PWD" "$1"
    cat
}
bad() { # NAME LINE-AND-TEXT; sections on stdin
    scenario 1 >"$dir/bad.ini"
    run sim "$dir/bad.ini"
    [ "$status" -eq 2 ] && [ ! -s "$dir/out" ] && grep -qF -e "$dir/bad.ini:$2" "$dir/err"
    verdict "$1" $?
}
scenario 3 <<END >"$dir/wall.ini"
[obstacle wall]
size_m = 4, 0.5, 4
start_m = 0, 10, 0
END
run sim "$dir/wall.ini" --json
has 'a target that is hidden from the first on' 0 'violations=0' 'targets=1'
printf 'o house\n' >"$dir/house.scene"
printf '2 9 -3\n6 9 -3\n6 12 -3\n2 12 -3\n' | sed 's/^/v /' >>"$dir/house.scene"
echo 'f 1 2 3 4' >>"$dir/house.scene"
scenario 2 <<END >"$dir/house.ini"
[scene]
file = house.scene
[flight]
velocity_mps = 1, 0, 0
[occlusion]
policy = drop
END
run sim "$dir/house.ini" --report "$dir/report"
[ "$status" -eq 0 ] && grep -q 'class="solid"' "$dir/report/report.html"
verdict 'a scene stands in the pictures of the report' $?
bad 'a box of two sides' "9: key 'size_m'" <<END
[obstacle wall]
size_m = 4, 0.5
start_m = 0, 10, 0
END
bad 'a fade beyond the forecast' "9: key 'ahead_s'" <<END
[occlusion]
ahead_s = 0.5
fade_s = 1
[obstacle wall]
size_m = 4, 0.5, 4
start_m = 0, 10, 0
END
bad 'an unknown policy' "9: key 'policy'" <<END
[occlusion]
policy = nervous
END
bad 'a flight with one value' "9: key 'velocity_mps'" <<END
[flight]
velocity_mps = 1
END
scenario 1 <<END >"$dir/none.ini"
[scene]
file = none.scene
END
run sim "$dir/none.ini"
[ "$status" -eq 2 ] && grep -q 'none.scene' "$dir/err"
verdict 'a scene that is not there' $?
finish
