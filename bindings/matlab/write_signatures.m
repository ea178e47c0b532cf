function file = write_signatures(folder)
%WRITE_SIGNATURES Write the file from which MATLAB completes arguments and options.
%   FILE = write_signatures(FOLDER) writes functionSignatures.json into the toolbox folder FOLDER, which
%   must be on the path with its MEX file. Methods and arguments are those of the classes, options
%   those of the MEX file. build_mex and CMake call it.
%
%   Example:
%      write_signatures(fullfile(pwd, 'toolbox'))
%
%   See also build_mex.

% SPDX-License-Identifier: MIT
entries = {['"roburoc4.asTimetable": {' inputs({described('columns', 'required', struct())})]};
classes = {'Robot', 'Simulator', 'Rate'};
purposes = purposes_of(fileread(fullfile(folder, '+roburoc4', 'Robot.m')));
for c = 1:numel(classes)
    text = fileread(fullfile(folder, '+roburoc4', [classes{c} '.m']));
    text = text(1:min([numel(text), regexp(text, 'methods \(.*Access = private\)', 'once')]));
    methods = regexp(text, '\n    function (?:\w+ = )?(?!get\.)(\w+)\(([^)]*)\)', 'tokens');
    for k = 1:numel(methods)
        key = [classes{c} '.' methods{k}{1}];
        given = arguments_of(key, strsplit(methods{k}{2}, ', '), purposes);
        if strcmp(methods{k}{1}, classes{c})
            made = ['"outputs": [{"name": "this", "type": "roburoc4.' classes{c} '"}], '];
        else
            made = '';
            given = [{sprintf('{"name": "this", "kind": "required", "type": "roburoc4.%s"}', ...
                classes{c})}, given]; %#ok<AGROW>
        end
        entries{end + 1} = sprintf('"roburoc4.%s": {%s%s', key, made, inputs(given)); %#ok<AGROW>
    end
end
file = fullfile(folder, 'functionSignatures.json');
output = fopen(file, 'w');
fprintf(output, '{"_schemaVersion": "1.0.0",\n%s}\n', strjoin(entries, sprintf(',\n')));
fclose(output);
end

function text = inputs(given)
text = ['"inputs": [' strjoin(given, ', ') ']}'];
end

function given = arguments_of(key, names, purposes)
% What a method takes: its arguments, those in varargin, and options.
ordered = {'Robot.arm', 'timeout'; 'Robot.goTo', 'theta_rad'; 'Robot.inputs', 'name'; ...
    'Robot.log', 'file'; 'Robot.log', 'service'; 'Robot.receive', 'timeout'; 'Robot.record', 'service'};
ordered = ordered(strcmp(ordered(:, 1), key), 2)';
given = {};
names = setdiff(names, [{'', 'this', 'varargin'}, ordered], 'stable');
for k = 1:numel(names)
    given{end + 1} = described(names{k}, 'required', struct()); %#ok<AGROW>
end
for k = 1:numel(ordered)
    given{end + 1} = described(ordered{k}, 'ordered', struct()); %#ok<AGROW>
end
options = options_of(key);
if ~any(strcmp(key, {'Robot.Robot', 'Simulator.connect'}))
    purposes = struct();
end
for k = 1:numel(options)
    given{end + 1} = described(options{k}, 'namevalue', purposes); %#ok<AGROW>
end
end

function options = options_of(key)
move = {'speed', 'clearance', 'timeout'};
robot = [{'timeout', 'wait_for_data', 'buffer', 'record'}, fieldnames(roburoc4_mex('options', false))'];
switch key
    case {'Robot.Robot', 'Simulator.connect'}
        options = robot;
    case 'Simulator.Simulator'
        options = [{'port', 'host'}, fieldnames(roburoc4_mex('options', true))'];
    case {'Robot.move', 'Robot.goTo'}
        options = move;
    case {'Robot.turn', 'Robot.arc'}
        options = [move, {'allow_turns'}];
    case 'Robot.moveFor'
        options = move(2:3);
    case 'Robot.rest'
        options = move(3);
    case 'Simulator.setFaults'
        options = {'loss', 'duplicate', 'reorder', 'corrupt', 'delay_ms', 'jitter_ms'};
    otherwise
        options = {};
end
end

function text = described(name, kind, purposes)
% An argument, with its type and purpose where they are known; most are scalar numbers.
services = '''iocard'',''telemeter'',''battery'',''localization'',''differential''';
number = '"numeric", "scalar"';
on = '"logical", "scalar"';
known = {'action', '"function_handle"', 'called with a struct; [] ends it'; ...
    'address', '"char"', 'HOST or HOST:PORT, from the factory 192.168.0.2'; ...
    'allow_turns', on, 'more than two turns are meant'; 'allow_unknown_override', on, ''; ...
    'angle_rad', number, 'to the right is negative'; ...
    'angular_rad_s', number, 'left is positive'; 'channel', '', 'index or name'; ...
    'clearance', number, 'metres to what telemeters see; 0: do not look (0.5)'; ...
    'columns', '"struct"', 'of one service, such as data.localization'; ...
    'control', '"char"', 'as roburoc4_sim.h names it'; ...
    'distance_m', number, 'backward is negative'; ...
    'file', '"file=*.mat"', 'MAT-file; '''' writes none'; ...
    'hertz', number, '0.1 to 200'; 'host', '"char"', 'address of this machine'; ...
    'ignore_other_commander', on, ''; 'keep_curvature', on, ''; ...
    'kind', ['"char", "choices={' services ',''event''}"'], 'a service with statuses, or event'; ...
    'line', '"char"', '''help'' lists all lines'; 'linear_m_s', number, 'forward is positive'; ...
    'name', '"char"', 'name of an input'; 'on', on, ''; ...
    'period_ms', number, 'multiple of 10, 10 to 2550'; ...
    'port', number, 'UDP port of this machine; 0 picks a free one'; ...
    'record', '"char"', ''; 'robot', '"roburoc4.Robot"', ''; 'robot_file', '"char"', ''; ...
    'service', ['"char", "choices={' services '}"'], 'a service with statuses'; ...
    'speed', number, 'm/s (0.3), or rad/s of a turn (0.5)'; ...
    'timeout', number, 'seconds'; ...
    'value', '', ''; 'wait_for_data', on, ''};
at = find(strcmp(known(:, 1), name));
type = number;
purpose = '';
if ~isempty(at)
    type = known{at, 2};
    purpose = known{at, 3};
end
if isfield(purposes, name)
    purpose = purposes.(name);
end
text = sprintf('{"name": "%s", "kind": "%s"', name, kind);
if ~isempty(type)
    text = [text ', "type": [' type ']'];
end
if ~isempty(purpose)
    text = [text ', "purpose": "' purpose '"'];
end
if strcmp(kind, 'ordered') && strcmp(name, 'service')
    text = [text ', "repeating": true'];
end
text = [text '}'];
end

function purposes = purposes_of(text)
% Of each option what the help of the class says: names with their defaults, blanks, and the purpose.
purposes = struct();
text = text(1:strfind(text, 'Robot methods:'));
blocks = regexp(text, '\n%      (\w[^\n]*(?:\n%       {5,}[^\n]*)*)', 'tokens');
names = '';
for k = 1:numel(blocks)
    halves = regexp(blocks{k}{1}, '^(.*?\S)(?: {2,}(\S.*))?$', 'tokens', 'once');
    names = [names ' ' halves{1}]; %#ok<AGROW>
    if halves{1}(end) ~= ','
        found = regexp(names, '(\w+)( \([^)]*\))?', 'tokens');
        for n = 1:numel(found)
            purposes.(found{n}{1}) = [regexprep(halves{2}, '\s*\n%\s*', ' ') strjoin(found{n}(2:end), '')];
        end
        names = '';
    end
end
end
