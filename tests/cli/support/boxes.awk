# Boxes as solids of a scene: NAME X Y Z WIDTH DEPTH HEIGHT a line. n: vertices before them.
{
    print "o " $1
    for (i = 0; i < 8; i++)
        print "v", $2 + (i % 2) * $5, $3 + int(i / 2) % 2 * $6, $4 + int(i / 4) * $7
    n += 8
    split("1 3 4 2 5 6 8 7 1 2 6 5 3 7 8 4 1 5 7 3 2 4 8 6", f, " ")
    for (k = 0; k < 6; k++)
        print "f", n - 8 + f[4 * k + 1], n - 8 + f[4 * k + 2], n - 8 + f[4 * k + 3], n - 8 + f[4 * k + 4]
}
