-- Who people are to others: a provider of identities, or a proxy before the server. Who came by one has
-- no password here ('' in people.password) until one is set.

CREATE TABLE identities (
    -- The issuer as its tokens name it, or 'proxy'.
    issuer      TEXT    NOT NULL,
    -- What the issuer calls the person, for ever.
    subject     TEXT    NOT NULL,
    person      BLOB    NOT NULL REFERENCES people (id),
    created_at  INTEGER NOT NULL,
    PRIMARY KEY (issuer, subject)
) STRICT, WITHOUT ROWID;
CREATE INDEX identities_of_person ON identities (person);

-- An invitation may be one person's: who comes by single sign-on under this address has accepted it.
-- In small letters.
ALTER TABLE invitations ADD COLUMN email TEXT;
CREATE INDEX invitations_by_email ON invitations (email) WHERE email IS NOT NULL;
