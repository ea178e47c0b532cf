function test_completion_knows_everything()
% functionSignatures.json has each public method with its arguments, and each option and service.
% SPDX-License-Identifier: MIT
root = fullfile(fileparts(fileparts(mfilename('fullpath'))), 'toolbox');
text = fileread(fullfile(root, 'functionSignatures.json'));
listed = jsondecode(text);
known = fieldnames(listed)';
known = known(strncmp(known, 'roburoc4', 8));
functions = {'roburoc4_asTimetable'};
classes = {'Robot', 'Simulator', 'Rate'};
for c = 1:numel(classes)
    [names, arguments_of] = public_methods(fullfile(root, '+roburoc4', [classes{c} '.m']));
    for k = 1:numel(names)
        functions{end + 1} = ['roburoc4_' classes{c} '_' names{k}]; %#ok<AGROW>
        check(isfield(listed, functions{end}), '%s is not listed', functions{end});
        check_arguments(functions{end}, inputs_of(listed.(functions{end})), arguments_of{k});
    end
end
check(isempty(setdiff(known, functions)), 'listed, but there is no such function: %s', ...
    strjoin(setdiff(known, functions), ', '));

% What the MEX file takes is what the message of a wrong option lists.
sim = roburoc4.Simulator();
check_options(listed.roburoc4_Robot_Robot, @() sim.connect('nothing', 1));
check_options(listed.roburoc4_Simulator_connect, @() sim.connect('nothing', 1));
check_options(listed.roburoc4_Simulator_Simulator, @() roburoc4.Simulator('nothing', 1));
check_options(listed.roburoc4_Simulator_setFaults, @() sim.setFaults('nothing', 1));
check_options(listed.roburoc4_Robot_move, @() error('There are speed, clearance, timeout'));
delete(sim);
choices = regexp(text, 'choices=\{([^}]*)\}', 'tokens');
services = {roburoc4.Service.IOCARD, roburoc4.Service.TELEMETER, roburoc4.Service.BATTERY, ...
    roburoc4.Service.LOCALIZATION, roburoc4.Service.DIFFERENTIAL};
check(numel(choices) == 7, '%d arguments are services', numel(choices));
for k = 1:numel(choices)
    listed = strsplit(strrep(choices{k}{1}, '''', ''), ',');
    check(isequal(sort(listed(~strcmp(listed, 'event'))), sort(services)), 'services');
end
end

function check_arguments(name, inputs, wanted)
% The arguments in their order; varargin stands for options and for what may be left out.
given = {};
for k = 1:numel(inputs)
    if ~strcmp(inputs{k}.kind, 'namevalue')
        given{end + 1} = inputs{k}.name; %#ok<AGROW>
    end
end
optional = any(strcmp(wanted, 'varargin'));
wanted = wanted(~strcmp(wanted, 'varargin') & ~strcmp(wanted, ''));
check(numel(given) >= numel(wanted) && ...
    strcmp(strjoin(given(1:numel(wanted)), ', '), strjoin(wanted, ', ')), ...
    '%s(%s) is listed as (%s)', name, strjoin(wanted, ', '), strjoin(given, ', '));
check(optional || numel(inputs) == numel(wanted), '%s has more arguments than there are', name);
end

function check_options(entry, action)
inputs = inputs_of(entry);
given = {};
for k = 1:numel(inputs)
    if strcmp(inputs{k}.kind, 'namevalue')
        given{end + 1} = inputs{k}.name; %#ok<AGROW>
    end
end
try
    action();
catch problem
    wanted = regexp(problem.message, 'There are (.*)$', 'tokens', 'once');
end
wanted = strsplit(wanted{1}, ', ');
check(isempty(setxor(given, wanted)), 'these options differ: %s', strjoin(setxor(given, wanted), ', '));
end

function inputs = inputs_of(entry)
% Objects with the same fields become a struct array, others a cell array.
inputs = entry.inputs;
if isstruct(inputs)
    inputs = num2cell(inputs);
end
end

function [names, arguments_of] = public_methods(file)
text = fileread(file);
hidden = regexp(text, 'methods \((Static, )?Access = private\)', 'once');
text = text(1:min([numel(text), hidden]));
found = regexp(text, '\n    function (?:\w+ = )?(?!get\.)(\w+)\(([^)]*)\)', 'tokens');
names = cell(1, numel(found));
arguments_of = cell(1, numel(found));
for k = 1:numel(found)
    names{k} = found{k}{1};
    arguments_of{k} = strsplit(found{k}{2}, ', ');
end
end
