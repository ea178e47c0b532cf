function table = asTimetable(columns)
%ASTIMETABLE Make a timetable of one service's columns.
%   TABLE = roburoc4.asTimetable(DATA.localization) takes the columns of a service, as load gives them
%   from a MAT-file of log, and returns a timetable whose row times are utc_s as datetimes, as record
%   and log do. Octave has no timetables: there it returns the columns unchanged.
%
%   Example:
%      data = load('drive.mat');
%      poses = roburoc4.asTimetable(data.localization);
%
%   See also roburoc4.Robot, timetable, synchronize.

% SPDX-License-Identifier: MIT
if isa(columns, 'timetable')
    table = columns;
    return
end
if ~isstruct(columns) || ~isscalar(columns) || ~isfield(columns, 'utc_s')
    error('roburoc4:badArgument', ['this is %s; give the columns of a service, such as ' ...
        'data.localization'], roburoc4.internal.kind(columns));
end
table = columns;
if exist('table2timetable') ~= 0 %#ok<EXIST>
    moments = datetime(columns.utc_s, 'ConvertFrom', 'posixtime', 'TimeZone', 'UTC');
    table = table2timetable(struct2table(columns), 'RowTimes', moments);
end
end
