# SPDX-License-Identifier: MIT
#
# The blocks of code of pages. A block that begins with a comment with a file's name is that file.
#
#   -v want=NAME PAGE       print the file of that name, or the first block in that language
#   pages.txt PAGE          print a script that types what a reader types, in the order of the page
#   -v check=1 pages.txt PAGE...  is each block typed, or in pages.txt? Prints "PAGE TEST" for rows that
#                           name a test

function complain(text) {
    print text >"/dev/stderr"
    bad = 1
}

# The row of pages.txt for a line, or for a whole block by its language and its first line.
function row_of(line,    i) {
    for (i = 1; i <= rows; i++) {
        if (row_page[i] == page && index(line, row_start[i]) == 1) {
            used[i] = 1
            return i
        }
    }
    return 0
}

# again(), in scripts/try-pages, decides whether a command that met a robot is worth another try.
function type(command) {
    if (command ~ /^(cmake|cc|pip|sudo|python3 -m|arm-none|cd|cp|mkdir|mkoctfile|export|\.) /) {
        print command "\ntest $? -eq 0" # -e does not see that "a && b" failed in a
    } else {
        printf "until %s\ndo again || break; done; tries=0\n", command
    }
}

function flush_octave() {
    if (octave != "") {
        type("octave-cli --quiet <<\"END\"\n" octave "END")
    }
    octave = ""
}

function type_block(    i) {
    if (language == "matlab" && file == "") { # all in one session
        octave = octave text
        return
    }
    flush_octave()
    if (file != "") {
        printf "cat >%s <<\"END\"\n%sEND\n", file, text
    } else if (language == "sh") {
        for (i = 1; i <= count; i++) {
            if (!row_of(lines[i])) {
                type(lines[i])
            }
        }
    } else if (language == "python") {
        type("python3 - <<\"END\"\n" text "END")
    }
}

# Whether the reader types something of a block; if not, it needs a row.
function is_typed(    i) {
    if (typing && language == "sh") {
        for (i = 1; i <= count; i++) {
            row_of(lines[i])
        }
        return 1
    }
    return typing && !row_of(lines[1])
}

function end_of_block() {
    file = ""
    if (match(lines[1], /^(\/\*|#|;|%) [A-Za-z_0-9]+\.[a-z]+( \*\/)?$/)) {
        split(lines[1], word, " ")
        file = word[2]
    }
    if (want != "") {
        if (!found && (file == want || language == want)) {
            printf "%s", text
            found = 1
        }
    } else if (check) {
        blocks++
        if (is_typed()) {
            typed++
            if (file == "" && language !~ /^(sh|python|matlab)$/) {
                complain(page ":" begun ": blocks in this language are not typed; see scripts/pages.txt")
            }
        } else if (!row_of("```" language) && !row_of(lines[1])) {
            complain(page ":" begun ": no test runs this block, and scripts/pages.txt has no reason for that")
        }
    } else if (is_typed()) {
        typed++
        type_block()
    }
}

FNR == 1 {
    page = FILENAME
    typing = page == "README.md"
}

FILENAME ~ /pages\.txt$/ {
    if ($0 != "" && !/^#/) {
        if (split($0, cell, / +:: +/) != 3) {
            complain(FILENAME ":" FNR ": not PAGE :: START :: WHY")
        }
        row_page[++rows] = cell[1]
        row_start[rows] = cell[2]
        if (check && cell[3] ~ /^[a-z0-9_]+\/[^ ]*$/) {
            print cell[1], cell[3]
        }
    }
    next
}

/^```/ {
    inside = !inside
    if (inside) {
        language = substr($1, 4)
        begun = FNR
        count = 0
        text = lines[1] = ""
    } else {
        end_of_block()
    }
    next
}

inside {
    lines[++count] = $0
    text = text $0 "\n"
    next
}

/^## / && page != "README.md" {
    typing = $0 == "## First drive"
}

# A command in the text.
typing && /^`roburoc4 / && !check && want == "" {
    split($0, part, "`")
    type("timeout --preserve-status -s INT 15 " part[2] " || test $? -eq 130")
}

END {
    flush_octave()
    for (i = 1; check && i <= rows; i++) {
        if (!used[i]) {
            complain("scripts/pages.txt: no such block: " row_page[i] " :: " row_start[i])
        }
    }
    if (want == "" && !typed) {
        complain("nothing is typed there: a tutorial is the section First drive")
    }
    if (check && !bad) {
        print blocks " blocks, of which " typed " are typed" >"/dev/stderr"
    }
    exit bad || (want != "" && !found)
}
