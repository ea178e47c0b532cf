function test_completion_knows_everything()
% functionSignatures.json has each method that the help of a class lists, and each option and service.
% SPDX-License-Identifier: MIT
folder = fileparts(which('roburoc4_mex'));
text = fileread(fullfile(folder, 'functionSignatures.json'));
listed = jsondecode(text);
classes = {'Robot', 'Simulator', 'Rate'};
for c = 1:numel(classes)
    page = fileread(fullfile(folder, '+roburoc4', [classes{c} '.m']));
    page = regexp(page, 'methods:(.*?)\n%\n', 'tokens', 'once');
    names = regexp(page{1}, '%      (\w+) +- ', 'tokens');
    check(numel(names) > 2, '%s has no methods', classes{c});
    for k = 1:numel(names)
        name = ['roburoc4_' classes{c} '_' names{k}{1}];
        check(isfield(listed, name), '%s is not listed', name);
    end
end
drive = names_of(listed.roburoc4_Robot_drive, false);
check(isequal(drive, {'this', 'linear_m_s', 'angular_rad_s'}), '%s', strjoin(drive, ', '));
check(~isempty(strfind(text, '"lease_ms", "kind": "namevalue", "type": ["numeric", "scalar"], "purpose": "dur')));

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

function names = names_of(entry, options)
% Of an entry's options, or of its other inputs: a struct array if all have the same fields.
inputs = entry.inputs;
if isstruct(inputs)
    inputs = num2cell(inputs);
end
wanted = cellfun(@(given) strcmp(given.kind, 'namevalue') == options, inputs);
names = cellfun(@(given) given.name, inputs(wanted), 'UniformOutput', false);
names = names(:)';
end

function check_options(entry, action)
try
    action();
catch problem
    wanted = regexp(problem.message, 'There are (.*)$', 'tokens', 'once');
end
wrong = setxor(names_of(entry, true), strsplit(wanted{1}, ', '));
check(isempty(wrong), 'these options differ: %s', strjoin(wrong, ', '));
end
