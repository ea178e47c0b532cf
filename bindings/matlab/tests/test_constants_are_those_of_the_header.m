function test_constants_are_those_of_the_header()
% The classes with constants have the names and the values of roburoc4.h, all of them, and these only.
% SPDX-License-Identifier: MIT
root = fileparts(fileparts(mfilename('fullpath')));
include = fullfile(root, '..', '..', 'include');
header = [fileread(fullfile(include, 'roburoc4_codec.h')), fileread(fullfile(include, 'roburoc4.h'))];
same('BatteryState', header, 'BATTERY', '\d+', {'NOT_KNOWN'});
same('LocalizationFlag', header, 'LOCALIZATION', '0x\w+', {});
same('Result', header, 'ERR', '\(-[23]\d\)', {'OK', 'CLOSED'});
check(roburoc4.Result.OK == 0 && roburoc4.BatteryState.NOT_KNOWN == 255, 'those of this package');
check(~isempty(strfind(header, sprintf('ERR_CLOSED (%d)', roburoc4.Result.CLOSED))), 'CLOSED');
end

function same(name, header, prefix, value, others)
% The constants of a class against '#define ROBUROC4_PREFIX_NAME VALUE', and the others.
found = regexp(header, ['#define ROBUROC4_' prefix '_(\w+) (' value ')'], 'tokens');
check(numel(found) > 2, 'only %d constants ROBUROC4_%s_', numel(found), prefix);
for k = 1:numel(found)
    wanted = str2double(regexprep(found{k}{2}, '[()]', ''));
    if isnan(wanted)
        wanted = hex2dec(found{k}{2}(3:end));
    end
    constant = sprintf('roburoc4.%s.%s', name, found{k}{1});
    check(double(eval(constant)) == wanted, '%s is not %d', constant, wanted);
end
file = fileread(fullfile(fileparts(fileparts(mfilename('fullpath'))), 'toolbox', '+roburoc4', [name '.m']));
count = numel(regexp(file, '\n    [A-Z_]+ = '));
check(count == numel(found) + numel(others), '%s has %d constants, the header %d', name, count, ...
    numel(found));
end
