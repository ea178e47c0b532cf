function test_page_runs_as_printed()
% The code of docs/matlab.md runs from top to bottom, as a new user types it, and draws its pictures.
% Only the address is another one: that of a simulator in virtual time.
% SPDX-License-Identifier: MIT
restored = without_display(); %#ok<NASGU>
root = fullfile(fileparts(mfilename('fullpath')), '..', '..', '..');
page = fileread(fullfile(root, 'docs', 'matlab.md'));
blocks = regexp(page, '```matlab\n(.*?)```', 'tokens');
check(numel(blocks) >= 9, 'only %d blocks', numel(blocks));
code = '';
for k = 1:numel(blocks)
    % What builds the MEX file has a test of its own; runtests is MATLAB's.
    if isempty(regexp(blocks{k}{1}, 'build_mex', 'once'))
        code = [code blocks{k}{1} sprintf('\n')]; %#ok<AGROW>
    end
end
address = 'roburoc4\.Robot\(''127\.0\.0\.1''(, )?';
check(numel(regexp(code, address)) == 2, 'other addresses than that of the page');
code = regexprep(code, address, 'page_world.connect(');
folder = getenv('ROBUROC4_PICTURES');
if isempty(folder)
    folder = tempdir();
end
before = pwd();
cleanup = onCleanup(@() leave(before));
cd(folder);
printed = typed(code);
check(~isempty(regexp(printed, 'm, front [\d.]+ m, battery 100 %', 'once')), '%s', printed);
names = regexp(page, 'images/(matlab-[\w-]+\.png)', 'tokens');
check(numel(names) == 4, '%d pictures on the page', numel(names));
for k = 1:numel(names)
    picture = dir(fullfile(folder, names{k}{1}));
    check(numel(picture) == 1 && picture.bytes > 3000, 'no picture %s', names{k}{1});
end
end

function page_printed = typed(page_code)
% In a workspace of its own: the page has its own variables.
page_world = roburoc4.Simulator(); %#ok<NASGU>
page_printed = evalc(page_code);
end

function leave(before)
cd(before);
close('all');
end
