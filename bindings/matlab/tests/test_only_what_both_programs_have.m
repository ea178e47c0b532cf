function test_only_what_both_programs_have()
% Each .m file keeps to the language and the functions that MATLAB R2018a and Octave 7 share: no
% syntax of one of them alone, and no function that is not in functions.txt.
% SPDX-License-Identifier: MIT
root = fileparts(fileparts(mfilename('fullpath')));
package = fullfile('toolbox', '+roburoc4');
folders = {'', 'toolbox', package, fullfile(package, '+internal'), fullfile('toolbox', 'doc'), ...
    fullfile('toolbox', 'simulink'), fullfile('toolbox', 'examples'), 'tests', fullfile('tests', 'matlab')};
known = listed(fullfile(root, 'tests', 'functions.txt'));
files = {};
for f = 1:numel(folders)
    found = dir(fullfile(root, folders{f}, '*.m'));
    files = [files, fullfile(root, folders{f}, {found.name})]; %#ok<AGROW>
end
check(numel(files) > 40, 'only %d files were found', numel(files));
[~, own] = cellfun(@fileparts, files, 'UniformOutput', false);
used = {};
for k = 1:numel(files)
    text = fileread(files{k});
    check_syntax(own{k}, text);
    used = [used, check_functions(own{k}, text, known, own)]; %#ok<AGROW>
end
check_rules(known);
idle = setdiff(known(:, 1)', used);
idle = idle(cellfun(@(name) any(exist(name) == [2 5]), idle)); % an Octave may lack one, as Octave 9 lacks runtests
check(isempty(idle) || ~exist('OCTAVE_VERSION', 'builtin'), ...
    'listed in functions.txt, but not used: %s', strjoin(idle, ', '));
end

% Comments and texts are not code. A quote after a word or a bracket transposes.
function code = stripped(code)
code = regexprep(code, '(?<![\w\)\]\}''.])''(?:[^''\n]|'''')*''', '''''');
code = regexprep(code, '"[^"\n]*"', '""');
code = regexprep(code, '%[^\n]*', '');
code = regexprep(code, '\.\.\.[^\n]*', '...');
end

function check_syntax(name, text)
% Only in Octave; then only in MATLAB, since R2018a or not in Octave 7.
unshared = {'#', 'a comment with #'; ...
    '\<(end(if|while|for|function|switch|_try_catch|parfor|classdef|methods|properties)|until)\>', ...
        'an end with a name'; ...
    '\<(unwind_protect\w*|end_unwind_protect)\>', 'unwind_protect'; ...
    '(?<![=<>~])[-+*/^|&]=(?!=)|\+\+|(?<!-)--(?!-)', 'an operator of C'; ...
    '!', 'a not of Octave'; ...
    '\) ?\(|\) ?\{', 'an index of a result'; ...
    '^ *(arguments|enumeration|events)\>', 'a block that one of them lacks'; ...
    '^(?! *(properties|methods|classdef)\>).*\(\s*(\w+\s*,\s*)*[A-Za-z]\w*\s*=[^=]', ...
        'name=value in a call'; ...
    '^ *import\>', 'import'};
code = stripped(text);
for k = 1:size(unshared, 1)
    place = regexp(code, unshared{k, 1}, 'once', 'lineanchors', 'dotexceptnewline');
    check(isempty(place), '%s, line %d: %s', name, 1 + sum(code(1:place) == sprintf('\n')), ...
        unshared{k, 2});
end
end

function check_rules(known)
% The rules above find what they are meant to find.
bad = {'x = 1; # one', 'endif', 'until x', 'unwind_protect', 'x += 1;', 'x++;', 'if !x', ...
    'x != 2', 'y = f(x)(2);', 'arguments', 'plot(x, LineWidth=2)', '    events'};
for k = 1:numel(bad)
    check_raises('roburoc4:check', @() check_syntax('a test', bad{k}));
end
if exist('OCTAVE_VERSION', 'builtin')
    check_raises('roburoc4:check', @() check_functions('a test', 'printf(1)', known, {}));
    check_raises('roburoc4:check', @() check_functions('a test', 'x = kill(1, 2)', known, {}));
end
check_syntax('a test', 'x = a'' + b.''; y = ''don''''t != #''; % it''s # fine');
end

function names = check_functions(file, text, known, own)
% The functions that Octave knows among the words of the code, without fields, methods and lines that
% define functions. OWN are the files of this project.
names = {};
if ~exist('OCTAVE_VERSION', 'builtin')
    return
end
code = regexprep(stripped(text), 'function [^\n]*', '');
words = unique(regexp(code, '(?<![\w.])[A-Za-z]\w*', 'match'));
words = words(~cellfun(@iskeyword, words));
for k = 1:numel(words)
    kind = exist(words{k});
    if kind ~= 2 && kind ~= 5 || any(strcmp(words{k}, own))
        continue
    end
    place = find(strcmp(words{k}, known(:, 1)), 1);
    check(~isempty(place), '%s: %s is not in functions.txt: does MATLAB R2018a have it?', file, ...
        words{k});
    check(~strcmp(known{place, 2}, 'octave') || ~isempty(strfind(text, 'OCTAVE_')), ...
        '%s: %s is Octave''s alone, and the file does not ask where it runs', file, words{k});
    call = ['(?<![\w.])' words{k} '\('];
    check(~strcmp(known{place, 2}, 'variable') || isempty(regexp(code, call, 'once')), ...
        '%s: %s is called, but a variable in functions.txt', file, words{k});
    names{end + 1} = words{k}; %#ok<AGROW>
end
end

function known = listed(file)
% Names; those that only Octave has are followed by 'octave'.
row_texts = strsplit(fileread(file), sprintf('\n'));
row_texts = row_texts(~cellfun(@(line) isempty(line) || line(1) == '#', row_texts));
known = cell(numel(row_texts), 2);
for k = 1:numel(row_texts)
    words = strsplit(strtrim(row_texts{k}), ' ');
    known{k, 1} = words{1};
    known{k, 2} = '';
    if numel(words) > 1
        known{k, 2} = words{2};
    end
end
end
