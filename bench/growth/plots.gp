# Plots the tables that measure.sh wrote into `dir`.
set terminal svg size 480,320 font "sans,11" background "#ffffff"
set datafile separator "\t"
set style data linespoints
set grid linetype 1 linewidth 1 linecolor rgb "#dddddd"
set rmargin 3
set key left top
set linetype 1 linecolor rgb "#1f5fa8" linewidth 2 pointtype 7 pointsize 0.5
set linetype 2 linecolor rgb "#c8551b" linewidth 2 pointtype 7 pointsize 0.5
set linetype 3 linecolor rgb "#3a8a4d" linewidth 2 pointtype 7 pointsize 0.5
set linetype 4 linecolor rgb "#999999" linewidth 1 dashtype 2
file(name, ending) = dir . "/" . name . ending

set logscale x
set format x "10^{%L}"

set output file("triangles", ".svg")
set xlabel "triangles"; set ylabel "ns for each ray"
set yrange [0:*]
plot for [kind = 1:3] file("triangles", ".tsv") using 1:(column(kind + 1)) title word("primary bounce shadow", kind), \
     for [kind = 1:3] "" using 1:(column(kind + 4)) linetype kind linewidth 1 dashtype 2 pointsize 0.25 \
       title kind == 1 ? "one by one" : ""

set output file("lights", ".svg")
set xlabel "lights"; set ylabel "µs for each sample"
plot file("lights", ".tsv") using 1:2 notitle

set output file("depth", ".svg")
set format x; set xtics (1, 2, 4, 8, 16, 32, 64)
set xlabel "longest path, in segments"; set ylabel "seconds"
plot file("depth", ".tsv") using 1:2 notitle
set format x "10^{%L}"; set xtics autofreq

# Straight lines through the last point: what cost in proportion would be.
set logscale y
set yrange [*:*]

set output file("pixels", ".svg")
stats file("pixels", ".tsv") using 1:2 nooutput
set xlabel "pixels"; set ylabel "seconds"
plot file("pixels", ".tsv") using 1:2 title "measured", STATS_max_y * x / STATS_max_x linetype 4 title "in proportion"

set output file("samples", ".svg")
stats file("samples", ".tsv") using 1:2 nooutput
set xlabel "samples per pixel"; set ylabel "seconds"
plot file("samples", ".tsv") using 1:2 title "measured", STATS_max_y * x / STATS_max_x linetype 4 title "in proportion"

unset logscale
set format x; set xtics 1
set xrange [0:*]
set yrange [0:*]
set ylabel "million samples per second"
do for [name in "threads workers"] {
  set output file(name, ".svg")
  stats file(name, ".tsv") using 2 every ::0::0 nooutput
  set xlabel name eq "threads" ? "threads of one process" : "workers of one thread"
  plot file(name, ".tsv") using 1:($2 / 1e6) title "measured", STATS_max * x / 1e6 linetype 4 title "in proportion to one"
}
