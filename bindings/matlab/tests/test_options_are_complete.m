function test_options_are_complete()
% Every setting of the client and every number of the simulator is an option; a value that it cannot
% have is refused with its name.
% SPDX-License-Identifier: MIT
root = fileparts(fileparts(mfilename('fullpath')));
include = fullfile(root, '..', '..', 'include');
header = fileread(fullfile(include, 'roburoc4.h'));

% The arrays of the struct are options by service, by role and by bit.
wanted = fields_of(header, 'roburoc4_config', {'size', 'subscriptions', 'options'});
services = {'iocard', 'telemeter', 'battery', 'localization', 'differential'};
roles = strrep(setdiff(defined(header, 'ROLE'), {'count'}), 'battery_v', 'battery_voltage');
wanted = [wanted, strcat(services, '_period_ms'), strcat(roles, '_index'), ...
    defined(header, 'OPTION'), ...
    {'buffer', 'record', 'timeout'}];
check(numel(wanted) > 22, 'only %d settings in the header', numel(wanted));
for k = 1:numel(wanted)
    refused(wanted{k}, @() roburoc4.Robot('127.0.0.1:9', wanted{k}, 1e12));
end

wanted = fields_of(fileread(fullfile(include, 'roburoc4_sim.h')), 'roburoc4_sim_config', {'size'});
check(numel(wanted) > 25, 'only %d settings in the header', numel(wanted));
for k = 1:numel(wanted)
    refused(wanted{k}, @() roburoc4.Simulator(wanted{k}, 'much'));
end
sim = roburoc4.Simulator('seed', 2, 'start_x_m', 1, 'start_y_m', 2, 'start_theta_rad', 3);
check(sim.state.true_y_m == 2 && sim.state.true_theta_rad == 3, 'start');
delete(sim);

sim = roburoc4.Simulator('iocard_id', 12, 'family', 4);
check(isnan(sim.state.distances_m(1)), 'this member of the family has no telemeter');
delete(sim);
refused('family', @() roburoc4.Simulator('family', -1));

file = [tempname() '.txt'];
remove = onCleanup(@() delete(file));
write(file, sprintf('[inputs]\noverride_index = 9\niocard_id = 12\n'));
sim = roburoc4.Simulator('robot_file', file);
robot = roburoc4.Robot(sim, 'robot_file', file);
sim.set('pad_a', true);
robot.sleep(1);
check(robot.status.overridden == 1, 'the input of the robot file is [A]');
delete(robot);
delete(sim);
write(file, sprintf('override_index = 9\nwatchdog = 12\n'));
for action = {@() roburoc4.Robot('127.0.0.1:9', 'robot_file', file), ...
        @() roburoc4.Simulator('robot_file', file)}
    try
        action{1}();
        check(false, 'a bad robot file is taken');
    catch problem
        check(~isempty(strfind(problem.message, 'line 2: no such name')), '%s', problem.message);
    end
end

sim = roburoc4.Simulator('as_manual', true);
check(sim.get('motor_button') == 0, 'as the manual says, nobody has pressed the button yet');
sim.set('motor_button', true);
check(sim.state.motors_enabled, 'the button');
sim.set('localization_flags', 82);
check(sim.get('localization_flags') == 82, 'localization');
delete(sim);
end

function write(file, text)
stream = fopen(file, 'w');
fwrite(stream, text);
fclose(stream);
end

function refused(option, action)
% As a bad value of this option, and not as an unknown option.
try
    action();
catch problem
    check(strcmp(problem.identifier, 'roburoc4:badArgument'), '%s: %s', option, problem.message);
    check(isempty(strfind(problem.message, 'there is no ')), '%s is no option', option);
    return
end
check(false, '%s: any value is taken', option);
end

function names = fields_of(header, type, others)
% The fields of a struct, without these and without arrays.
text = regexp(header, ['typedef struct ' type ' \{(.*?)\} ' type ';'], 'tokens', 'once');
text = regexprep(text{1}, '/\*.*?\*/', '');
declared = regexp(text, '(?:u?int\d+_t|float|double) ([^;]*);', 'tokens');
names = {};
for k = 1:numel(declared)
    names = [names, strtrim(strsplit(declared{k}{1}, ','))]; %#ok<AGROW>
end
names = names(cellfun(@(name) isempty(strfind(name, '[')), names));
names = setdiff(names, others);
end

function names = defined(header, kind)
found = regexp(header, ['#define ROBUROC4_' kind '_(\w+) '], 'tokens');
names = cellfun(@(one) lower(one{1}), found, 'UniformOutput', false);
end
