function table = table2timetable(table, name, moments)
%TABLE2TIMETABLE A stand-in for MATLAB's, for tests in Octave.
%
%   Example:
%      table2timetable(struct2table(s), 'RowTimes', datetime(s.utc_s, 'ConvertFrom', 'posixtime'))

% SPDX-License-Identifier: MIT
check(strcmp(name, 'RowTimes') && numel(moments) == size(table.time_s, 1), 'row times');
table.Time = moments;
end
