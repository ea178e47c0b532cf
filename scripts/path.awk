# SPDX-License-Identifier: MIT
#
# Judge and draw the path of drive_square. Reads its file of poses ("x_m,y_m,theta_rad" a line, of a
# simulated robot followed by its true pose); writes SVG into SVG=FILE; prints the verdict; ends with 0
# only if the path is long enough, passes each corner and comes back.
#
# All poses are turned into the frame of their own first one: X ahead, Y to the left.

BEGIN {
    FS = ","
    SIDE = 2
    NEAR = 0.3
    LONG = 7.5
    corners = 4
    corner_x[1] = SIDE; corner_y[1] = 0
    corner_x[2] = SIDE; corner_y[2] = SIDE
    corner_x[3] = 0; corner_y[3] = SIDE
    corner_x[4] = 0; corner_y[4] = 0
}

NF >= 3 {
    if (!n++)
        begin("odometry", $1, $2, $3)
    place("odometry", $1, $2)
    odometry_x[n] = px
    odometry_y[n] = py
}

NF >= 6 {
    if (!m++)
        begin("true", $4, $5, $6)
    place("true", $4, $5)
    true_x[m] = px
    true_y[m] = py
    true_turn = ($6 - start_theta["true"]) * 57.29578
}

END {
    judge()
    explain()
    if (SVG != "")
        draw()
    exit verdict
}

function begin(frame, x, y, theta) {
    start_x[frame] = x
    start_y[frame] = y
    start_theta[frame] = theta
}

function place(frame, x, y,    ahead, aside) {
    ahead = x - start_x[frame]
    aside = y - start_y[frame]
    px = ahead * cos(start_theta[frame]) + aside * sin(start_theta[frame])
    py = aside * cos(start_theta[frame]) - ahead * sin(start_theta[frame])
}

function distance(x1, y1, x2, y2) {
    return sqrt((x1 - x2) * (x1 - x2) + (y1 - y2) * (y1 - y2))
}

# Corners count in their order, each from where the one before was nearest.
function judge(    k, i, from, best, d) {
    verdict = 0
    total = 0
    for (i = 2; i <= n; i++)
        total += distance(odometry_x[i], odometry_y[i], odometry_x[i - 1], odometry_y[i - 1])
    claim("path length", total, total >= LONG, "at least " LONG " m")
    from = 1
    for (k = 1; k < corners; k++) {
        best = 1e9
        for (i = from; i <= n && distance(odometry_x[i], odometry_y[i], corner_x[k], corner_y[k]) > SIDE / 2; i++)
            ;
        for (; i <= n; i++) {
            d = distance(odometry_x[i], odometry_y[i], corner_x[k], corner_y[k])
            if (d < best) {
                best = d
                from = i
            }
            if (d > SIDE / 2)
                break
        }
        claim("corner " k " missed by", best, best <= NEAR, "at most " NEAR " m")
    }
    d = n ? distance(odometry_x[n], odometry_y[n], 0, 0) : 1e9
    claim("end off the start by", d, d <= NEAR, "at most " NEAR " m")
}

function claim(what, value, good, wanted) {
    if (value > 1e8)
        printf "%-4s  %-22s never there  (%s)\n", "BAD", what, wanted
    else
        printf "%-4s  %-22s %6.3f m  (%s)\n", good ? "ok" : "BAD", what, value, wanted
    if (!good)
        verdict = 1
}

# Why odometry and true path differ, or the picture looks like a failure.
function explain() {
    if (!n)
        return
    print "The square is driven and judged by odometry, the position that the robot computes from its wheels."
    print "The wheels slip when this robot turns, and odometry does not notice: the true path does not close."
    if (m)
        printf "The simulator slips, too: it really ended %.2f m from its start, %.0f degrees off.\n",
            distance(true_x[m], true_y[m], 0, 0), degrees_off(true_turn)
}

function degrees_off(turn) {
    turn = (turn % 360 + 540) % 360 - 180
    return turn < 0 ? -turn : turn
}

# From metres to the picture.
function X(x) {
    return sprintf("%.1f", 60 + (x - LEFT) * SCALE)
}

function Y(y) {
    return sprintf("%.1f", 60 + (TOP - y) * SCALE)
}

function floor_to(value, step,    k) {
    k = int(value / step)
    return (k * step > value ? k - 1 : k) * step
}

function bounds(x, y) {
    if (x < LEFT) LEFT = x
    if (x > RIGHT) RIGHT = x
    if (y < BOTTOM) BOTTOM = y
    if (y > TOP) TOP = y
}

function text(x, y, anchor, what) {
    printf "<text x=\"%s\" y=\"%s\" text-anchor=\"%s\">%s</text>\n", x, y, anchor, what > SVG
}

function dot(x, y, colour) {
    printf "<circle cx=\"%s\" cy=\"%s\" r=\"6\" fill=\"%s\"/>\n", X(x), Y(y), colour > SVG
}

function path(xs, ys, count, style,    i, last) {
    printf "<polyline fill=\"none\" %s points=\"", style > SVG
    for (i = 1; i <= count; i++)
        if (i == 1 || i == count || distance(xs[i], ys[i], xs[last], ys[last]) * SCALE > 2) {
            printf "%s,%s ", X(xs[i]), Y(ys[i]) > SVG
            last = i
        }
    print "\"/>" > SVG
}

function draw(    i, width, height, y) {
    LEFT = BOTTOM = -0.3
    RIGHT = TOP = SIDE + 0.3
    for (i = 1; i <= n; i++) bounds(odometry_x[i], odometry_y[i])
    for (i = 1; i <= m; i++) bounds(true_x[i], true_y[i])
    LEFT = floor_to(LEFT, 0.5); BOTTOM = floor_to(BOTTOM, 0.5)
    RIGHT = floor_to(RIGHT, 0.5) + 0.5; TOP = floor_to(TOP, 0.5) + 0.5
    SCALE = 600 / (RIGHT - LEFT > TOP - BOTTOM ? RIGHT - LEFT : TOP - BOTTOM)
    width = X(RIGHT) + 30
    height = Y(BOTTOM) + (m ? 200 : 130)

    printf "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" ", width, height > SVG
    print "font-family=\"sans-serif\" font-size=\"14\" fill=\"#222\">" > SVG
    print "<title>RobuROC4: a square of 2 m, driven by odometry</title>" > SVG
    print "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>" > SVG
    print "<text x=\"60\" y=\"34\" font-size=\"20\">A square of " SIDE " m, driven by the robot\047s odometry</text>" > SVG
    for (i = LEFT; i <= RIGHT + 0.01; i += 0.5) {
        printf "<line x1=\"%s\" y1=\"%s\" x2=\"%s\" y2=\"%s\" stroke=\"#ddd\"/>\n", X(i), Y(BOTTOM), X(i), Y(TOP) > SVG
        text(X(i), Y(BOTTOM) + 20, "middle", i)
    }
    for (i = BOTTOM; i <= TOP + 0.01; i += 0.5) {
        printf "<line x1=\"%s\" y1=\"%s\" x2=\"%s\" y2=\"%s\" stroke=\"#ddd\"/>\n", X(LEFT), Y(i), X(RIGHT), Y(i) > SVG
        text(X(LEFT) - 8, Y(i) + 5, "end", i)
    }
    text(X((LEFT + RIGHT) / 2), Y(BOTTOM) + 42, "middle", "x, ahead of the start, in m")
    printf "<text transform=\"translate(20 %s) rotate(-90)\" text-anchor=\"middle\">y, to the left, in m</text>\n", Y((BOTTOM + TOP) / 2) > SVG
    printf "<rect x=\"%s\" y=\"%s\" width=\"%s\" height=\"%s\" fill=\"none\" stroke=\"#888\" stroke-dasharray=\"6 5\"/>\n", X(0), Y(SIDE), SIDE * SCALE, SIDE * SCALE > SVG
    if (m)
        path(true_x, true_y, m, "stroke=\"#d95f02\" stroke-width=\"2.5\"")
    path(odometry_x, odometry_y, n, "stroke=\"#1f77b4\" stroke-width=\"2.5\"")
    if (m)
        dot(true_x[m], true_y[m], "#d95f02")
    if (n)
        dot(odometry_x[n], odometry_y[n], "#1f77b4")
    printf "<circle cx=\"%s\" cy=\"%s\" r=\"9\" fill=\"none\" stroke=\"#2a2\" stroke-width=\"3\"/>\n", X(0), Y(0) > SVG

    y = Y(BOTTOM) + 72
    legend(60, y, "#1f77b4", "where the robot believes it was (odometry)")
    legend(420, y, "#2a2", "ring: start; dots: ends")
    legend(420, y + 24, "#888", "dashed: the square")
    if (m) {
        legend(60, y + 24, "#d95f02", "where it really was (simulated)")
        text(60, y + 58, "start", "The program steers by odometry, that is by how far the wheels rolled. They slip")
        text(60, y + 78, "start", "when the robot turns, so it really turns less than it believes, and the true path")
        text(60, y + 98, "start", "does not close. A real RobuROC4 does the same: it is no fault of the program.")
    }
    print "</svg>" > SVG
    close(SVG)
}

function legend(x, y, colour, what) {
    printf "<line x1=\"%d\" y1=\"%d\" x2=\"%d\" y2=\"%d\" stroke=\"%s\" stroke-width=\"3\"/>\n", x, y - 5, x + 24, y - 5, colour > SVG
    text(x + 32, y, "start", what)
}
