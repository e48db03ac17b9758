#!/bin/sh
# `detect` from outside: pictures in, target lines out; bad input; a film of real people, where there is one.
. tests/cli/support/check.sh

# disc U V: a PGM picture of 96 x 64 with a bright disc of 8 pixels radius there.
disc() {
    printf 'P5 # a comment\n96 64\n255\n'
    LC_ALL=C awk -v cu="$1" -v cv="$2" 'BEGIN { for (v = 0; v < 64; v++) for (u = 0; u < 96; u++)
        printf "%c", (u - cu) ^ 2 + (v - cv) ^ 2 < 64 ? 230 : 40 + (u * 7 + v * 3) % 11 }'
}
disc 40 30 >"$dir/a.pgm"
disc 41 30 >"$dir/b.pgm"

run detect --find markers "$dir/a.pgm" "$dir/b.pgm" --fps 10
[ "$status" -eq 0 ] && [ ! -s "$dir/err" ] && [ "$(wc -l <"$dir/out")" -eq 1 ]
verdict 'a marker is told when it is seen twice' $?
facts && [ "$(fact t_us)" = 100000 ] && [ "$(fact id)" = 1000000 ] && [ "$(fact object)" = '"marker"' ] &&
    awk -v u="$(fact 'px[0]')" -v v="$(fact 'px[1]')" 'BEGIN { exit !((u - 41) ^ 2 + (v - 30) ^ 2 < 0.01) }'
verdict 'its line: time, id, place' $?

# Red, green and blue alike are the same grey; several pictures in a stream; both ways the same lines.
ppm() { LC_ALL=C awk -v cu="$1" 'BEGIN { printf "P6\n96 64\n255\n"; for (v = 0; v < 64; v++) for (u = 0; u < 96; u++) {
    c = sprintf("%c", (u - cu) ^ 2 + (v - 30) ^ 2 < 64 ? 230 : 40 + (u * 7 + v * 3) % 11); printf "%s%s%s", c, c, c } }'; }
cp "$dir/out" "$dir/files"
{ ppm 40; ppm 41; } | "$boresight" detect --find markers --fps 10 >"$dir/out" 2>"$dir/err"
cmp -s "$dir/out" "$dir/files"
verdict 'PPM pictures in a stream: the same lines as PGM files' $?

# With a rig: the direction of the pixel. At heading 180 the camera looks south; (41, 30) of 96 x 64 pixels is left of the
# middle and above it: with 4.8 x 3.2 mm, f = 6 mm: -6.5 / 120 to the right, 1.5 / 120 up. Seen from a gimbal turned by 90
# degrees (west), right is north.
sed -e 's/^sensor_height_mm.*/sensor_height_mm = 3.2/' -e '/^margin/a\
width_px = 96\
height_px = 64\
focal_mm = 6' host-sim/rigs/studio.ini >"$dir/rig.ini"
direction() { # NAME PAN EAST NORTH UP
    run detect --find markers --rig "$dir/rig.ini" --pan "$2" "$dir/a.pgm" "$dir/b.pgm"
    facts && awk -v x="$(fact 'dir[0]')" -v y="$(fact 'dir[1]')" -v z="$(fact 'dir[2]')" -v a="$3" -v b="$4" -v c="$5" 'BEGIN {
        n = sqrt(x * x + y * y + z * z); m = sqrt(a * a + b * b + c * c)
        exit !((x / n - a / m) ^ 2 + (y / n - b / m) ^ 2 + (z / n - c / m) ^ 2 < 0.0005 ^ 2) }'
    verdict "$1" $?
}
direction 'with a rig that looks south: the direction' 0 0.0541667 -1 0.0125
direction 'and turned to the west' 90 -1 -0.0541667 0.0125

# What detect prints, run takes.
"$boresight" detect --find markers --rig "$dir/rig.ini" "$dir/a.pgm" "$dir/b.pgm" "$dir/b.pgm" >"$dir/lines"
run run "$dir/rig.ini" --arm --seconds 1 --targets - --json <"$dir/lines"
cp "$dir/err" "$dir/told" && : >"$dir/err"
has 'run takes the lines' 0 'targets=1' 'bad_lines=0' 'violations=0'

# ---------------------------------------------------------------- bad input
head -c 3000 "$dir/a.pgm" >"$dir/cut.pgm"
printf 'P5 96 64 65535\n' >"$dir/deep.pgm"
printf 'P5 9600 64 255\n' >"$dir/wide.pgm"
printf 'P2 1 1 255 7' >"$dir/text.pgm"
printf '\377\330\377\300' >"$dir/short.jpg"
printf 'P5 3 3 255\n123456789' >"$dir/tiny.pgm"
refuse 'a picture that is not there' 'no.pgm' detect "$dir/no.pgm"
refuse 'a picture that is cut off' 'cut.pgm: picture 1: is cut off' detect "$dir/cut.pgm"
refuse 'more than 8 bits' 'deep.pgm: picture 1: has more than 8 bits' detect "$dir/deep.pgm"
refuse 'a picture that is too wide' 'larger than 8192' detect "$dir/wide.pgm"
refuse 'another format' 'is no PGM (P5), PPM (P6) or JPEG' detect "$dir/text.pgm"
refuse 'a JPEG picture without an end' 'short.jpg: picture 1: ' detect "$dir/short.jpg"
refuse 'a picture of a few pixels' '16 x 16' detect "$dir/tiny.pgm"
refuse 'no picture at all' 'stdin: picture 1: is empty' detect </dev/null
refuse 'a detector that is none' "no detector 'cats'" detect --find cats "$dir/a.pgm"
refuse 'no detector' '--find' detect --find '' "$dir/a.pgm"
refuse 'a family that is none' 'must be one of' detect --family tag99 "$dir/a.pgm"
refuse 'a pose without a rig' '--rig' detect --pan 5 "$dir/a.pgm"
refuse 'a rate of 0' '--fps' detect --fps 0 "$dir/a.pgm"
rig_with() { sed "/^margin/a\\
$1" host-sim/rigs/studio.ini >"$dir/bad.ini"; }
rig_with 'k1 = -3'
refuse 'a lens that folds its picture' "bad.ini:40: key 'k1': has a distortion" detect --rig "$dir/bad.ini" "$dir/a.pgm"
rig_with 'detect = dogs'
refuse 'a rig with a detector that is none' "bad.ini:40: key 'detect': no detector 'dogs'" detect --rig "$dir/bad.ini" "$dir/a.pgm"

# ---------------------------------------------------------------- real people
film=/usr/share/doc/opencv-doc/examples/data/vtest.avi
if [ ! -r "$film" ]; then
    echo "SKIP a film of real people: no $film; it comes with the package opencv-doc"
elif ! command -v ffmpeg >/dev/null 2>&1; then
    echo 'SKIP a film of real people: no ffmpeg to decode it'
else
    ffmpeg -v error -i "$film" -f image2pipe -c:v pgm -pix_fmt gray - 2>"$dir/told" |
        "$boresight" detect --find motion --fps 10 --stats >"$dir/out" 2>"$dir/err"
    status=$?
    grep -q '795 frames' "$dir/err"
    verdict 'a film of 795 frames' $?
    sed 's/^boresight detect: /MEASURED film of pedestrians: /' "$dir/err"
    people=$(awk -v fps=10 -f tests/cli/support/film.awk tests/data/film_people.txt "$dir/out")
    echo "MEASURED film of pedestrians, 8 frames labelled by hand: $people (found, labelled, boxes without a person)"
    echo "$people" | awk '{ exit !($2 == 44 && $1 >= 0.85 * $2 && $3 <= 4) }'
    verdict 'at least 85 % of the people labelled by hand' $?
    people=$(awk -v fps=10 -v score_min=1 -f tests/cli/support/film.awk tests/data/pedestrians.csv "$dir/out")
    echo "MEASURED film of pedestrians, beside a person detector's surest boxes: ${people% *} (found, boxes)"
    echo "$people" | awk '{ exit !($2 == 1688 && $1 >= 0.85 * $2) }'
    verdict 'at least 85 % of what a person detector is sure of' $?
fi
finish
