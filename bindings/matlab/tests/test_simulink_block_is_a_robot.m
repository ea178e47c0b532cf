function test_simulink_block_is_a_robot()
% roburoc4.System has the methods that MathWorks documents, with their inputs and outputs; with a
% stand-in for matlab.System it drives, closes a loop, and stops. (In MATLAB: try roburoc4_model.)
% SPDX-License-Identifier: MIT
if ~exist('OCTAVE_VERSION', 'builtin')
    return
end
here = fileparts(mfilename('fullpath'));
toolbox = fullfile(here, '..', 'toolbox');
text = fileread(fullfile(toolbox, '+roburoc4', 'System.m'));
documented = fullfile(here, 'documented', 'system.txt');
check_interface(text, documented);
wrong = {'getNumInputsImpl(~)', 'getNumInputs(~)'; 'outputImpl(this, ~, ~, ~)', 'outputImpl(this)'; ...
    'bumpers] = isOutputComplexImpl', 'bumpers, more] = isOutputComplexImpl'; ...
    'count = 3;', 'count = 2;'; 'count = 6;', 'count = 5;'; 'releaseImpl', 'endImpl'};
for k = 1:size(wrong, 1)
    check_raises('roburoc4:check', @() check_interface(strrep(text, wrong{k, :}), documented));
end
scripts = {'roburoc4_model', 'roburoc4_library'};
for k = 1:numel(scripts)
    check_parameters(fileread(fullfile(toolbox, 'simulink', [scripts{k} '.m'])), text);
end

% Octave lets only the class itself call what is protected.
folder = tempname();
mkdir(folder);
cleanup = onCleanup(@() remove(folder));
public = regexprep(text, '\(Access = (protected|private)\)', '');
public = strrep(public, 'classdef System', 'classdef published_system');
public = strrep(public, 'function this = System(', 'function this = published_system(');
handle = fopen(fullfile(folder, 'published_system.m'), 'w');
fprintf(handle, '%s', public);
fclose(handle);
addpath(folder, fullfile(here, 'simulink'));

% An hour of the model takes no hour, and the block's outputs have their documented form.
s = published_system('max_linear_m_s', 0.4);
[outputs{1:6}] = s.step(0.3, 0, false);
[sizes{1:6}] = s.getOutputSizeImpl();
[types{1:6}] = s.getOutputDataTypeImpl();
for k = 1:6
    check(isequal(size(outputs{k}), sizes{k}) && isa(outputs{k}, types{k}), 'output %d', k);
end
for k = 1:40
    [pose, speeds, remaining_percent, state, distances_m, bumpers] = s.step(0.5, 0, true);
end
check(all(distances_m > 0) && isequal(bumpers, [0 0]), 'telemeters and bumpers');
check(abs(speeds(1) - 0.4) < 0.02, 'limited to 0.4 m/s: %g m/s', speeds(1));
check(pose(1) > 0.4 && pose(1) < 0.8, 'it came %g m far', pose(1));
check(isequal(state, [1 1 0 0]) && remaining_percent > 50, 'state');

% When arm becomes false it stops, and what disarms it keeps it so.
for k = 1:40
    [~, speeds, ~, state] = s.step(0.5, 0, false);
end
check(max(abs(speeds)) < 0.02 && ~state(2), 'disarmed, but at %g m/s', speeds(1));
s.simulator.set('estop_remote', true);
for k = 1:60
    [~, speeds, ~, state] = s.step(0.5, 0, true);
end
s.simulator.set('estop_remote', false);
s.simulator.set('motor_button', true);
for k = 1:40
    [~, speeds, ~, state] = s.step(0.5, 0, true);
end
check(~state(2) && max(abs(speeds)) < 0.02, 'it armed itself after an emergency stop');
s.step(0.5, 0, false);
for k = 1:20
    [~, speeds] = s.step(0.5, 0, true);
end
check(speeds(1) > 0.1, 'a new arming did not help');
s.release();
check(living_robots() == 0, 'a robot is left');
pose = s.step(0, 0, false);
check(isequal(pose, [0 0 0]), 'a second run does not start from the beginning');
s.release();

% With the wall clock a step takes its time; an address needs that clock.
s = published_system('clock', 'wall', 'sample_time_s', 0.02);
s.step(0, 0, false);
begun = tic();
for k = 1:10
    s.step(0, 0, false);
end
check(toc(begun) > 0.15, 'ten steps of 0.02 s in %g s', toc(begun));
s.release();
s = published_system('address', '127.0.0.1');
check_raises('roburoc4:badArgument', @() s.step(0, 0, false));
s = published_system('sample_time_s', 0.3);
check_raises('roburoc4:badArgument', @() s.step(0, 0, false));
end

function check_interface(text, file)
listed = strsplit(strtrim(regexprep(fileread(file), '#[^\n]*\n', '')), sprintf('\n'));
inputs = number(text, 'getNumInputsImpl');
outputs = number(text, 'getNumOutputsImpl');
check(numel(regexp(text, '\n    function [^\n]*Impl\(')) == numel(listed), 'not all methods are listed');
for k = 1:numel(listed)
    parts = strsplit(listed{k}, ' ');
    found = regexp(text, ['\n    function ([^\n(]*)' parts{1} '\(([^)]*)\)'], 'tokens');
    check(numel(found) == 1, '%s is missing', parts{1});
    given = numel(regexp(found{1}{2}, '~|\w+'));
    check(given == wanted(parts{2}, inputs, outputs) + ~strcmp(parts{2}, 'static'), ...
        '%s has %d inputs', parts{1}, given);
    given = numel(regexp(found{1}{1}, '\w+'));
    check(given == wanted(parts{3}, inputs, outputs), '%s has %d outputs', parts{1}, given);
end
end

function count = wanted(word, inputs, outputs)
counts = struct('static', 0, 'in', inputs, 'out', outputs);
count = str2double(word);
if isfield(counts, word)
    count = counts.(word);
end
end

function count = number(text, method)
found = regexp(text, [method '\(~\)\s+count = (\d+);'], 'tokens', 'once');
check(~isempty(found), 'there is no %s', method);
count = str2double(found{1});
end

function check_parameters(script, text)
% The block has the properties and outputs that the scripts set and connect.
for name = regexp(script, '''([a-z_]+_s)'', ''[\d.]+''', 'tokens')
    check(~isempty(regexp(text, ['\n +' name{1}{1} ' = '], 'once')), 'there is no %s', name{1}{1});
end
for name = regexp(script, 'outputs = \{([^}]*)\}', 'tokens')
    check(~isempty(strfind(text, ['[' strrep(name{1}{1}, '''', '') '] = getOutputNamesImpl'])), ...
        'the outputs are not %s', name{1}{1});
end
check(~isempty(strfind(script, '''System'', ''roburoc4.System''')), 'another System object');
end

function remove(folder)
rmpath(folder);
confirm_recursive_rmdir(false, 'local');
rmdir(folder, 's');
end
