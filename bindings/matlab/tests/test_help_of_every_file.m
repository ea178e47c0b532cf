function test_help_of_every_file()
% Each public file begins with an H1 line, has an example, and its methods have help; the help of the
% class has each field of a struct.
% SPDX-License-Identifier: MIT
root = fileparts(fileparts(mfilename('fullpath')));
package = fullfile(root, 'toolbox', '+roburoc4');
folders = {package, fullfile(package, '+internal'), fullfile(root, 'toolbox'), ...
    fullfile(root, 'toolbox', 'simulink'), fullfile(root, 'toolbox', 'examples'), root};
for f = 1:numel(folders)
    files = dir(fullfile(folders{f}, '*.m'));
    check(~isempty(files), 'no files in %s', folders{f});
    for k = 1:numel(files)
        name = files(k).name(1:end - 2);
        text = fileread(fullfile(folders{f}, files(k).name));
        if ~strcmp(name, 'Contents')
            h1 = regexp(text, '^[^\n]*\n\s*%([A-Z0-9_]+) [^\n]+[^\n,]\n', 'tokens', 'once');
            check(~isempty(h1) && strcmpi(h1{1}, name), '%s has no H1 line', name);
        end
        check(~isempty(strfind(text, 'Example:')), '%s has no example', name);
        check(~isempty(strfind(text, 'SPDX-License-Identifier')), '%s has no licence', name);
    end
end
classes = {'Robot', 'Simulator', 'Rate'};
for k = 1:numel(classes)
    text = fileread(fullfile(package, [classes{k} '.m']));
    hidden = regexp(text, 'methods \((Static, )?Access = private\)', 'once');
    text = text(1:min([numel(text), hidden]));
    names = regexp(text, '\n    function [^\n]*?(\w+)\(this[^\n]*\)\n        %([A-Z]+) ', 'tokens');
    all_names = regexp(text, '\n    function (?!\w+ = get\.)[^\n]*?(\w+)\(this', 'tokens');
    check(numel(names) == numel(all_names), 'a method of %s has no help', classes{k});
    for n = 1:numel(names)
        check(strcmpi(names{n}{1}, names{n}{2}), 'help of %s.%s', classes{k}, names{n}{1});
        check_shown(classes{k}, names{n}{1});
    end
end
shown = regexp(fileread(fullfile(package, 'Robot.m')), 'fields of the structs, which are:.*?Example:', ...
    'match', 'once');
check_fields(shown, 'the help of Robot', ' %s[,\\s]');
end

function check_fields(page, name, pattern)
sim = roburoc4.Simulator();
r = sim.connect();
fields = [fieldnames(r.status); fieldnames(r.link); fieldnames(r.info)];
for k = 1:numel(fields)
    check(~isempty(regexp(page, sprintf(pattern, fields{k}), 'once')), '%s does not have %s', name, ...
        fields{k});
end
delete(r);
delete(sim);
end

function check_shown(class_name, method)
% What help shows. Octave takes the comment before a method, if there is one, and of a method with
% the name of a function in a file, that function.
if exist(method) ~= 2 %#ok<EXIST>
    shown = evalc(['help roburoc4.' class_name '.' method]);
    check(~isempty(strfind(shown, [upper(method) ' '])), 'help shows %s', shown);
end
end
