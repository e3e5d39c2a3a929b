-- Words of SQLite that statements use and PostgreSQL does not have, taught to it: so one text serves both.

-- The entries of a JSON array, numbered from 0: texts as they are, all else as JSON.
CREATE FUNCTION json_each(list TEXT, OUT key BIGINT, OUT value TEXT) RETURNS SETOF RECORD
LANGUAGE SQL IMMUTABLE ROWS 20 AS $$
    SELECT e.ordinality - 1, e.value #>> '{}' FROM json_array_elements(list::JSON) WITH ORDINALITY e
$$;

-- What stands at a path such as $.test.max_strain or $.fibres[0].length_mm, if anything does.
CREATE FUNCTION json_at(document TEXT, path TEXT) RETURNS JSONB LANGUAGE SQL IMMUTABLE AS $$
    SELECT jsonb_path_query_first(document::JSONB, ('strict ' || path)::JSONPATH, '{}', TRUE)
$$;

-- The same as a text: a text as it is, all else as JSON.
CREATE FUNCTION json_extract(document TEXT, path TEXT) RETURNS TEXT LANGUAGE SQL IMMUTABLE AS $$
    SELECT json_at(document, path) #>> '{}'
$$;

-- The same as JSON.
CREATE FUNCTION json_part(document TEXT, path TEXT) RETURNS TEXT LANGUAGE SQL IMMUTABLE AS $$
    SELECT json_at(document, path)::TEXT
$$;
CREATE OPERATOR -> (LEFTARG = TEXT, RIGHTARG = TEXT, FUNCTION = json_part);

-- Its type, in SQLite's words.
CREATE FUNCTION json_type(document TEXT, path TEXT) RETURNS TEXT LANGUAGE SQL IMMUTABLE AS $$
    SELECT CASE jsonb_typeof(part)
        WHEN 'string' THEN 'text'
        WHEN 'boolean' THEN part::TEXT
        WHEN 'number' THEN CASE WHEN part::TEXT ~ '^-?[0-9]+$' THEN 'integer' ELSE 'real' END
        ELSE jsonb_typeof(part) END
    FROM json_at(document, path) part
$$;

CREATE FUNCTION json_array_length(document TEXT, path TEXT) RETURNS BIGINT LANGUAGE SQL IMMUTABLE AS $$
    SELECT CASE jsonb_typeof(part) WHEN 'array' THEN jsonb_array_length(part) ELSE 0 END
    FROM json_at(document, path) part
$$;

CREATE FUNCTION json_quote(value TEXT) RETURNS TEXT LANGUAGE SQL IMMUTABLE AS $$
    SELECT to_json(value)::TEXT
$$;

-- An attempt as a list of jobs shows it.
CREATE FUNCTION json_object(TEXT, BIGINT, TEXT, TEXT, TEXT, TEXT, TEXT, BIGINT, TEXT, BIGINT, TEXT, TEXT, TEXT, TEXT)
RETURNS JSON LANGUAGE SQL IMMUTABLE AS $$
    SELECT json_build_object($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14)
$$;

CREATE FUNCTION json_added(list TEXT[], entry TEXT) RETURNS TEXT[] LANGUAGE SQL IMMUTABLE AS $$
    SELECT array_append(list, to_json(entry)::TEXT)
$$;
CREATE FUNCTION json_added(list TEXT[], entry JSON) RETURNS TEXT[] LANGUAGE SQL IMMUTABLE AS $$
    SELECT array_append(list, entry::TEXT)
$$;
CREATE FUNCTION json_listed(list TEXT[]) RETURNS TEXT LANGUAGE SQL IMMUTABLE AS $$
    SELECT '[' || array_to_string(list, ',') || ']'
$$;
CREATE AGGREGATE json_group_array(TEXT) (SFUNC = json_added, STYPE = TEXT[], FINALFUNC = json_listed, INITCOND = '{}');
CREATE AGGREGATE json_group_array(JSON) (SFUNC = json_added, STYPE = TEXT[], FINALFUNC = json_listed, INITCOND = '{}');

CREATE FUNCTION hex(bytes BYTEA) RETURNS TEXT LANGUAGE SQL IMMUTABLE AS $$
    SELECT upper(encode(bytes, 'hex'))
$$;
CREATE FUNCTION unhex(digits TEXT) RETURNS BYTEA LANGUAGE SQL IMMUTABLE AS $$
    SELECT decode(digits, 'hex')
$$;
CREATE FUNCTION instr(text_in TEXT, sought TEXT) RETURNS BIGINT LANGUAGE SQL IMMUTABLE AS $$
    SELECT strpos(text_in, sought)::BIGINT
$$;

-- In small letters, those of every language.
CREATE FUNCTION folded(text_in TEXT) RETURNS TEXT LANGUAGE SQL IMMUTABLE AS $$
    SELECT lower(text_in COLLATE "und-x-icu")
$$;

-- What a job is estimated to take [ms of one core].
CREATE FUNCTION core_ms(estimate TEXT) RETURNS BIGINT LANGUAGE SQL IMMUTABLE AS $$
    SELECT trunc(1000 * LEAST(COALESCE(json_extract(estimate, '$.wall_s')::DOUBLE PRECISION, 0), 1e9))::BIGINT
$$;
