# A park of 100 trees of 20 points each, south of the origin; the same on every machine. Metres.
function draw() { seed = (seed * 16807) % 2147483647; return seed / 2147483647 }
BEGIN {
    seed = 19750601
    for (tree = 0; tree < 100; tree++) {
        printf "o tree %d\n", tree
        x = 80 * draw() - 40; y = -90 + 60 * draw(); z = 6 * draw()
        for (i = 0; i < 20; i++) {
            a = x + 2 * draw(); b = y + 2 * draw(); c = z + 4 * draw()
            printf "v %.3f %.3f %.3f\n", a, b, c
        }
    }
}
